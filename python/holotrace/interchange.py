"""Fields, holograms and pictures as others keep them: xarray, MATLAB files, HoloTorch and slmsuite.

``ht.Field(tensor, pitch=..., wavelength=...)`` takes any array or tensor of the shape (ny, nx) whose row 0 is the top row, and
``np.asarray(field)`` or ``torch.from_dlpack(field)`` gives one: turn tensors of torchoptics over (``tensor.flip(-2)``), and transpose those of odak where their
axes are (nx, ny). docs/how_to/come_from_other_packages.md says what differs in axes, units and signs.
"""

from __future__ import annotations

import os
from typing import Any, Dict, List, Optional, Union

import numpy as np

from . import _core
from ._arrays import array_of, real_numbers
from ._fields import Field, Path
from ._holograms import Hologram, Slm
from ._images import Image
from ._units import Length

Plane = Union[Field, Hologram, Image]


def _places(count: int, pitch: float, centre: float, is_row: bool) -> np.ndarray[Any, Any]:
    index = np.arange(count) - (count - 1) / 2
    places: np.ndarray[Any, Any] = centre + (-index if is_row else index) * pitch
    return places


def to_xarray(plane: Plane) -> Any:
    """A DataArray with the coordinates y and x [m] (y falls: row 0 is on top), and all else in its attributes.

    Its values are the memory of the plane, not a copy.
    """
    import xarray

    rows, columns = plane.shape[:2]
    pitch = plane.pitch if plane.pitch > 0 else 1.0
    centre = plane.centre if isinstance(plane, Field) else (0.0, 0.0)
    coordinates: Dict[str, Any] = {
        "y": ("y", _places(rows, pitch, centre[1], True), {"units": "m"}),
        "x": ("x", _places(columns, pitch, centre[0], False), {"units": "m"}),
    }
    attributes: Dict[str, Any] = {"pitch": plane.pitch}
    dims = ["y", "x"]
    if isinstance(plane, Field):
        attributes.update(units="sqrt(W/m2)", wavelength=plane.wavelength, z=plane.z, image=plane.image)
        values, name = plane.samples, "field"
    elif isinstance(plane, Hologram):
        attributes.update(
            units="1", wavelength=plane.wavelength, levels=plane.levels, modulation=plane.modulation, image=plane.image
        )
        values, name = plane.level, "level"
    else:
        attributes.update(units="W/m2")
        values, name = plane.pixels, "light"
        if plane.channels == 3:
            dims.append("channel")
            coordinates["channel"] = ["red", "green", "blue"]
    return xarray.DataArray(values, dims=dims, coords=coordinates, attrs=attributes, name=name)


def from_xarray(array: Any, *, pitch: Optional[Length] = None, wavelength: Optional[Length] = None) -> Field:
    """The field of a DataArray with the dimensions y and x. y may rise or fall; the field's falls.

    Pitch, centre, wavelength and z are those of its coordinates [m] and attributes, where they are not given.
    """
    if set(array.dims) != {"y", "x"}:
        raise _core.Error(f"expected the dimensions y and x, got {', '.join(map(str, array.dims))}")
    array = array.transpose("y", "x")
    if "y" in array.coords and array.sizes["y"] > 1 and float(array.y[0]) < float(array.y[-1]):
        array = array.isel(y=slice(None, None, -1))
    if pitch is None:
        if "x" in array.coords and array.sizes["x"] > 1:
            steps = [np.diff(np.asarray(array[axis], float)) for axis in ("x", "y") if array.sizes[axis] > 1]
            pitch = float(abs(steps[0].mean()))
            if any(np.abs(np.abs(step) - pitch).max() > 1e-6 * pitch for step in steps):
                raise _core.Error("expected coordinates x and y in even steps of one pitch, got others")
        elif "pitch" in array.attrs:
            pitch = float(array.attrs["pitch"])
        else:
            raise _core.Error("expected coordinates x and y [m] or the attribute pitch, got none; give the pitch")
    wavelength = wavelength if wavelength is not None else array.attrs.get("wavelength")
    if wavelength is None:
        raise _core.Error("expected the attribute wavelength [m], got none; give the wavelength")
    centre = [float(array[axis].mean()) if axis in array.coords else 0.0 for axis in ("x", "y")]
    return Field(
        array.values, pitch, wavelength, z=array.attrs.get("z", 0.0), centre=centre,
        image=array.attrs.get("image", "virtual"),
    )


def save_mat(path: Path, plane: Plane) -> None:
    """Write a MATLAB file: the array as ``field``, ``level`` or ``light``, with ``pitch``, ``wavelength``, … beside it."""
    from scipy.io import savemat

    values: Dict[str, Any] = {"pitch": plane.pitch}
    if isinstance(plane, Field):
        values.update(
            field=plane.samples, wavelength=plane.wavelength, z=plane.z, centre=np.array(plane.centre), image=plane.image
        )
    elif isinstance(plane, Hologram):
        values.update(
            level=plane.level, wavelength=plane.wavelength, levels=plane.levels, modulation=plane.modulation,
            image=plane.image,
        )
    else:
        values.update(light=plane.pixels)
    savemat(os.fspath(path), values)


def load_mat(
    path: Path, name: Optional[str] = None, *, pitch: Optional[Length] = None, wavelength: Optional[Length] = None
) -> Plane:
    """What ``save_mat`` wrote, or the array ``name`` of any MATLAB file as a field, with its pitch and wavelength."""
    from scipy.io import loadmat

    held = loadmat(os.fspath(path))
    names = [key for key in held if not key.startswith("__")]
    name = name or next((key for key in ("field", "level", "light") if key in held), None)
    if name is None or name not in held:
        raise _core.Error(f"expected an array {name or 'field, level or light'} in {path}, got {', '.join(names)}")

    def number(key: str) -> Optional[float]:
        return float(held[key].item()) if key in held else None

    def text(key: str, default: str) -> str:
        return str(held[key].item()) if key in held else default

    step: Optional[Length] = pitch if pitch is not None else number("pitch")
    if name == "light":
        return Image(held[name], step or 0.0)
    colour: Optional[Length] = wavelength if wavelength is not None else number("wavelength")
    if step is None or colour is None:
        raise _core.Error(f"expected pitch and wavelength in {path}; give them")
    image = text("image", "virtual")
    if name == "level":
        return Hologram(
            held[name], step, colour, levels=int(number("levels") or 256), modulation=text("modulation", "phase"),
            image=image,
        )
    centre = [float(one) for one in np.ravel(held["centre"])] if "centre" in held else [0.0, 0.0]
    return Field(held[name], step, colour, z=number("z") or 0.0, centre=centre, image=image)


def from_holotorch(field: Any) -> List[Field]:
    """The fields of a HoloTorch ``ElectricField`` (B, T, P, C, H, W): one for each of all but the last two dimensions."""
    data = array_of(field.data, "the data of an ElectricField")
    wavelengths = real_numbers(field.wavelengths.data_tensor, "wavelengths", np.float64).ravel()
    pitch = float(real_numbers(field.spacing.data_tensor, "spacing", np.float64).ravel()[0])
    if data.ndim != 6 or data.shape[3] != len(wavelengths):
        raise _core.Error(f"expected the shape (B, T, P, C, H, W) with {len(wavelengths)} wavelengths, got {data.shape}")
    flat = data.reshape((-1,) + data.shape[3:])
    return [Field(one[c], pitch, float(wavelengths[c])) for one in flat for c in range(data.shape[3])]


def to_slmsuite(hologram: Hologram) -> np.ndarray[Any, Any]:
    """The phase pattern in radians that slmsuite's ``slm.set_phase`` and ``slm.write`` take."""
    return hologram.phase


def from_slmsuite(phase: Any, pitch: Length, wavelength: Length, *, slm: Optional[Slm] = None) -> Hologram:
    """The hologram of a phase pattern of slmsuite, of any offset in radians."""
    return Hologram.from_phase(phase, pitch, wavelength, levels=slm.levels if slm else 256, slm=slm)
