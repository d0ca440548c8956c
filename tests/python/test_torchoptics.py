"""Propagation against torchoptics, which shares no code with this project."""

import numpy as np
import pytest

import holotrace as ht

torch = pytest.importorskip("torch", reason="torch is not installed; pip install torch")
torchoptics = pytest.importorskip("torchoptics", reason="torchoptics is not installed; pip install torchoptics")

PITCH, WAVELENGTH = 8e-6, 532e-9


def gaussian(ny, nx):
    """A beam limited in space and in band, off the axis, so that no axis can be mistaken for the other."""
    y, x = (np.arange(n) - (n - 1) / 2 for n in (ny, nx))
    return np.exp(-(((x - 7) / 12) ** 2) - ((y[:, None] + 4) / 9) ** 2 + 0.3j * x)


def relative(a, b):
    return np.linalg.norm(a - b) / np.linalg.norm(b)


@pytest.mark.parametrize(
    "theirs, ours, distance", [("DIM", "rayleigh-sommerfeld", 0.03), ("ASM", "angular-spectrum", 0.005)]
)
def test_propagation_is_that_of_torchoptics(theirs, ours, distance):
    """Both compute the same integral in double precision: the project's goal is 1e-9."""
    samples = gaussian(96, 112)
    field = torchoptics.Field(torch.from_numpy(samples), wavelength=WAVELENGTH, spacing=PITCH)
    moved = field.propagate_to_z(distance, propagation_method=theirs).data.numpy()
    own = ht.propagate(ht.Field(samples, PITCH, WAVELENGTH), distance, method=ours)
    assert own.dtype == np.complex128
    assert relative(own.samples, moved) <= 1e-9
