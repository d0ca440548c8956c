"""Round trips through what other packages keep."""

from types import SimpleNamespace

import numpy as np
import pytest

import holotrace as ht
from holotrace import interchange

HOLOGRAM = ht.Hologram(np.arange(12).reshape(3, 4), "8 um", "532 nm", levels=16, image="real")


def described(field):
    return field.pitch, field.wavelength, field.z, *field.shape


def test_fields_survive_xarray(field):
    xarray = pytest.importorskip("xarray", reason="xarray is not installed; pip install xarray")
    moved = ht.propagate(field, 0.01, centre_x="80 um")
    array = interchange.to_xarray(moved)
    assert np.shares_memory(array.values, moved.samples)
    assert array.x.attrs["units"] == "m" and float(array.y[0]) > float(array.y[-1])
    for given in (array, array.isel(y=slice(None, None, -1)), array.transpose("x", "y")):
        back = interchange.from_xarray(given)
        assert (back.samples == moved.samples).all()
        assert described(back) == pytest.approx(described(moved)) and back.centre == pytest.approx(moved.centre)
        assert back.image == moved.image
    assert interchange.to_xarray(ht.Image(np.ones((2, 3, 3)))).dims == ("y", "x", "channel")
    assert interchange.to_xarray(HOLOGRAM).attrs["levels"] == 16
    with pytest.raises(ht.Error, match="give the wavelength"):
        interchange.from_xarray(xarray.DataArray(np.ones((2, 2)), dims=["y", "x"]), pitch=1e-6)


def test_planes_survive_matlab_files(field, tmp_path):
    pytest.importorskip("scipy", reason="scipy is not installed; pip install scipy")
    for plane in (ht.propagate(field, 0.01, centre_x="80 um"), HOLOGRAM, ht.Image(np.ones((3, 4, 3)), "5 um")):
        interchange.save_mat(tmp_path / "plane.mat", plane)
        back = interchange.load_mat(tmp_path / "plane.mat")
        assert repr(back) == repr(plane) and (np.asarray(back) == np.asarray(plane)).all()
    from scipy.io import savemat

    savemat(tmp_path / "theirs.mat", {"U": np.ones((2, 3)) * 1j})
    other = interchange.load_mat(tmp_path / "theirs.mat", "U", pitch="8 um", wavelength="532 nm")
    assert isinstance(other, ht.Field) and other.samples[1, 2] == 1j
    with pytest.raises(ht.Error, match="expected an array V in .*, got U"):
        interchange.load_mat(tmp_path / "theirs.mat", "V")


def test_slmsuite_phases_are_radians():
    phase = interchange.to_slmsuite(HOLOGRAM)
    assert phase[0, 1] == 2 * np.pi / 16
    back = interchange.from_slmsuite(phase - 4 * np.pi, "8 um", "532 nm", slm=ht.Slm(columns=4, rows=3, pitch=8e-6, levels=16))
    assert (back.level == HOLOGRAM.level).all()


def test_holotorch_fields_are_one_for_each_wavelength():
    """An object as HoloTorch has it: data (B, T, P, C, H, W), wavelengths and spacing as tensors."""
    class Tensor(np.ndarray):
        def cpu(self):
            return np.asarray(self)

        def detach(self):
            return self

    data = (np.arange(2 * 2 * 3 * 4).reshape(2, 1, 1, 2, 3, 4) * 1j).astype(np.complex64).view(Tensor)
    theirs = SimpleNamespace(
        data=data, wavelengths=SimpleNamespace(data_tensor=np.array([638e-9, 520e-9]).view(Tensor)),
        spacing=SimpleNamespace(data_tensor=np.array([[8e-6, 8e-6]]).view(Tensor)))
    fields = interchange.from_holotorch(theirs)
    assert [field.wavelength for field in fields] == [638e-9, 520e-9] * 2
    assert (fields[3].samples == np.asarray(data)[1, 0, 0, 1]).all() and fields[0].pitch == 8e-6
