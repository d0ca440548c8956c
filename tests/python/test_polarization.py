"""Polarization of scenes, judged by NumPy on what the program makes."""

import numpy as np
import pytest

import holotrace as ht


def wall(sheet, **more):
    """A shining wall of 2 mm, 60 mm behind the panel, and a larger sheet 10 mm before it."""
    return ht.Scene(
        wavelength="532 nm", slm={"columns": 256, "rows": 256}, polarization=True,
        materials={"lamp": {"emission": 1.0}, "sheet": sheet},
        object=[{"type": "quad", "width": "2 mm", "height": "2 mm", "position": "0 0 -60 mm", "material": "lamp"},
                {"type": "quad", "width": "20 mm", "height": "20 mm", "position": "0 0 -50 mm", "material": "sheet"}], **more)


def test_speckle_of_two_polarizations():
    """A plate at 45 deg leaves unpolarised light as it is: two speckle patterns of equal means add to a contrast of 1/sqrt(2). About
    16,000 cells of speckle are in view, and the contrast of so many is within 0.01."""
    scene = wall({"type": "retarder", "axis": "45 deg", "delay": "90 deg"},
                 trace={"separate_polarizations": True, "columns": 256, "rows": 256, "paths": 4, "phase": "random"})
    parts = [np.abs(np.asarray(ht.propagate(field, "-60 mm"))) ** 2 for field in ht.fields(scene)]
    assert len(parts) == 2
    inner = (slice(48, 208),) * 2  # within the wall's image, away from its edge
    contrast = [part[inner].std() / part[inner].mean() for part in (*parts, parts[0] + parts[1])]
    assert contrast == pytest.approx([1, 1, np.sqrt(0.5)], abs=0.03)
    assert contrast[2] == pytest.approx(np.sqrt(0.5), abs=0.01)
