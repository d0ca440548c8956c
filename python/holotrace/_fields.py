"""Field and Sources."""

from __future__ import annotations

import os
from typing import Any, List, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core, _picture
from ._arrays import complex_samples, real_numbers
from ._checked import count, items, text
from ._noun import ArrayNoun, Noun
from ._units import Length, Lengths, check_metres, format_length

Path = Union[str, "os.PathLike[str]"]


class Field(ArrayNoun):
    """Monochromatic scalar light on a grid of samples.

    A sample is a complex amplitude in sqrt(W/m2); power is the sum of ``|u|**2 * pitch**2``. The array has the shape
    (ny, nx), row 0 on top (largest y). Light that leaves a point is ``exp(+ikr)``. ``np.asarray(field)`` and
    ``torch.from_dlpack(field)`` are the memory of the field itself, not a copy.

    Parameters
    ----------
    samples : array of the shape (ny, nx)
        Complex amplitudes, or real ones with the phase 0. complex64 and complex128 keep their precision. Tensors of other
        libraries may be on any device, as wherever arrays are taken.
    pitch : length
        Distance between samples, in metres or as text: ``8e-6``, ``"8 um"``.
    wavelength : length
        Wavelength of the light: ``632.8e-9``, ``"632.8 nm"``.
    z : length
        Position of the plane; the panel is at 0.
    centre : two lengths
        x and y of the grid's centre.
    image : "virtual" or "real"
        Image that the field shows: behind the panel, or in front of it.
    """

    __slots__ = ()

    def __init__(
        self,
        samples: Any,
        pitch: Length,
        wavelength: Length,
        *,
        z: Length = 0.0,
        centre: Lengths = (0.0, 0.0),
        image: str = "virtual",
        name: str = "",
    ) -> None:
        array = complex_samples(samples)
        kind = _core.Field32 if array.dtype == np.complex64 else _core.Field64
        self._core = kind.make(array, pitch, wavelength)
        self._core.z = z
        self._core.centre = centre
        self._core.image = text(image, "image")
        self._core.name = text(name, "name")
        self.facts = {}

    @property
    def samples(self) -> np.ndarray[Any, Any]:
        """Samples of the shape (ny, nx), a view of the field's memory."""
        array: np.ndarray[Any, Any] = self._core.samples
        return array

    @property
    def _values(self) -> np.ndarray[Any, Any]:
        return self.samples

    @property
    def shape(self) -> Tuple[int, int]:
        """(ny, nx)"""
        rows, columns = self.samples.shape
        return rows, columns

    @property
    def dtype(self) -> np.dtype[Any]:
        """complex64 or complex128"""
        dtype: np.dtype[Any] = self.samples.dtype
        return dtype

    @property
    def pitch(self) -> float:
        """Distance between samples [m]."""
        return float(self._core.pitch)

    @property
    def wavelength(self) -> float:
        """[m]"""
        return float(self._core.wavelength)

    @property
    def z(self) -> float:
        """Position of the plane [m]."""
        return float(self._core.z)

    @property
    def centre(self) -> Tuple[float, float]:
        """x and y of the centre [m]."""
        x, y = self._core.centre
        return x, y

    @property
    def image(self) -> str:
        """ "virtual" or "real" """
        return str(self._core.image)

    @property
    def name(self) -> str:
        """Name of the path group or light that it shows; "" for all light."""
        return str(self._core.name)

    @property
    def cone_wavelength(self) -> float:
        """Wavelength whose cone the light keeps to [m]; 0 for its own."""
        return float(self._core.cone_wavelength)

    @property
    def power(self) -> float:
        """Optical power [W]."""
        return float(self._core.power)

    @property
    def x(self) -> np.ndarray[Any, Any]:
        """x of each column [m], rising to the right."""
        columns = self.shape[1]
        places: np.ndarray[Any, Any] = self.centre[0] + (np.arange(columns) - (columns - 1) / 2) * self.pitch
        return places

    @property
    def y(self) -> np.ndarray[Any, Any]:
        """y of each row [m], falling, because row 0 is on top."""
        rows = self.shape[0]
        places: np.ndarray[Any, Any] = self.centre[1] + ((rows - 1) / 2 - np.arange(rows)) * self.pitch
        return places

    @property
    def amplitude(self) -> np.ndarray[Any, Any]:
        """Modulus of the samples [sqrt(W/m2)]."""
        modulus: np.ndarray[Any, Any] = np.abs(self.samples)
        return modulus

    @property
    def phase(self) -> np.ndarray[Any, Any]:
        """Phase of the samples [rad], in (-pi, pi]."""
        radians: np.ndarray[Any, Any] = np.angle(self.samples)
        return radians

    @property
    def irradiance(self) -> np.ndarray[Any, Any]:
        """``|u|**2`` [W/m2]."""
        u = self.samples
        irradiance: np.ndarray[Any, Any] = u.real**2 + u.imag**2
        return irradiance

    def astype(self, dtype: Any) -> "Field":
        """The field in the precision complex64 or complex128."""
        wanted = np.dtype(dtype)
        if wanted == np.complex64:
            return Field._of(self._core.as_single(), self.facts)
        if wanted == np.complex128:
            return Field._of(self._core.as_double(), self.facts)
        raise _core.Error(f"expected complex64 or complex128, got {wanted}")

    def save(self, path: Path) -> None:
        """Write .npy (with a sidecar .npy.json), .h5 or .exr."""
        save_fields(path, [self])

    def __repr__(self) -> str:
        rows, columns = self.shape
        place = f", z={format_length(self.z)}" if self.z != 0 else ""
        return (
            f"Field({columns} x {rows}, {self.dtype}, pitch={format_length(self.pitch)}, "
            f"wavelength={format_length(self.wavelength)}{place}, power={self.power:.4g} W)"
        )

    def _repr_html_(self) -> str:
        light = _picture.reduced(self.irradiance)
        step = -(-max(self.shape) // 384)
        phase = np.angle(self.samples[::step, ::step])
        return _picture.page(
            repr(self),
            [
                ("irradiance", _picture.grey(light, float(np.percentile(light, 99.9)))),
                ("phase", _picture.turns(phase)),
            ],
        )


def load_fields(path: Path, *, double: bool = False, allow_outside: bool = False) -> List[Field]:
    """The fields of a file, one for each wavelength. ``double`` keeps complex128."""
    load = _core.load_fields_double if double else _core.load_fields
    return [Field._of(core) for core in load(os.fspath(path), allow_outside)]


def load_field(path: Path, *, double: bool = False, allow_outside: bool = False) -> Field:
    """The field of a file (.npy, .h5, .exr) of one wavelength."""
    fields = load_fields(path, double=double, allow_outside=allow_outside)
    if len(fields) != 1:
        raise _core.Error(f"expected a field of one wavelength in {path}, got {len(fields)}; use load_fields")
    return fields[0]


def save_fields(path: Path, fields: Sequence[Field]) -> None:
    """Write fields that differ only in their wavelength into one file."""
    given = items(fields, "fields to save")
    for field in given:
        if not isinstance(field, Field):
            raise _core.Error(f"expected a Field to save, got {type(field).__name__}")
    cores = [field._core for field in given]
    if any(type(core) is not type(cores[0]) for core in cores):
        cores = [core.as_double() for core in cores]
    _core.save_fields(os.fspath(path), cores)


class Sources(Noun):
    """Waves of one wavelength that leave points behind the panel, or converge to points in front of it.

    Parameters
    ----------
    positions : array of the shape (n, 3)
        x, y, z in metres; z below 0 behind the panel, above 0 in front of it.
    amplitudes : array of n numbers, or one
        Amplitudes on the panel at normal incidence [sqrt(W/m2)].
    phases : array of n numbers, or one
        Phases at the points [rad].
    wavelength : length
    second_foci, focal_lines : arrays of the shape (n, 3)
        Of astigmatic waves, which leave two focal lines: a place of the second one [m], and the unit vector along the first one,
        which goes through the position, at right angles to the way from there to the second focus. Waves whose focal line
        is 0 are spherical.
    """

    __slots__ = ()

    def __init__(
        self,
        positions: Any,
        amplitudes: Any = 1.0,
        phases: Any = 0.0,
        *,
        wavelength: Length,
        name: str = "",
        second_foci: Any = None,
        focal_lines: Any = None,
    ) -> None:
        places = real_numbers(positions, "positions", np.float64)
        if places.ndim != 2:
            raise _core.Error(f"expected positions of the shape (n, 3), got {places.shape}")
        check_metres(places, "positions")
        count = len(places)
        each = [
            np.full(count, given, np.float32) if given.size == 1 else given
            for given in (real_numbers(amplitudes, "amplitudes"), real_numbers(phases, "phases"))
        ]
        for array, what in zip(each, ("amplitudes", "phases")):
            if array.ndim != 1:
                raise _core.Error(f"expected one row of {what}, got an array of the shape {array.shape}")
        foci, lines = (
            np.empty((0, 3)) if given is None else real_numbers(given, what, np.float64)
            for given, what in ((second_foci, "second_foci"), (focal_lines, "focal_lines"))
        )
        for array, what in ((foci, "second_foci"), (lines, "focal_lines")):
            if array.ndim != 2:
                raise _core.Error(f"expected {what} of the shape (n, 3), got {array.shape}")
        self._core = _core.Sources.make(places, each[0], each[1], foci, lines, wavelength)
        self._core.name = text(name, "name")
        self.facts = {}

    def __len__(self) -> int:
        return len(self._core)

    @property
    def positions(self) -> np.ndarray[Any, Any]:
        """Places of the shape (n, 3) [m], a view."""
        array: np.ndarray[Any, Any] = self._core.positions
        return array

    @property
    def amplitudes(self) -> np.ndarray[Any, Any]:
        """Amplitudes [sqrt(W/m2)], a view."""
        array: np.ndarray[Any, Any] = self._core.amplitudes
        return array

    @property
    def phases(self) -> np.ndarray[Any, Any]:
        """Phases [rad], a view."""
        array: np.ndarray[Any, Any] = self._core.phases
        return array

    @property
    def second_foci(self) -> np.ndarray[Any, Any]:
        """Places of the second focal lines, of the shape (n, 3) [m], or (0, 3) if all waves are spherical; a view."""
        array: np.ndarray[Any, Any] = self._core.second_foci
        return array

    @property
    def focal_lines(self) -> np.ndarray[Any, Any]:
        """Unit vectors along the focal lines through the positions, as second_foci; a view."""
        array: np.ndarray[Any, Any] = self._core.focal_lines
        return array

    @property
    def wavelength(self) -> float:
        """[m]"""
        return float(self._core.wavelength)

    @property
    def name(self) -> str:
        """Name of the path group or light; "" for all light."""
        return str(self._core.name)

    def with_frame(self, frame: int) -> "Sources":
        """The same waves with the random phases of another frame of a time-multiplexed hologram."""
        other = self.copy()
        other._core.set_frame(count(frame, "frame", most=2**32 - 1))
        return other

    def save(self, path: Path) -> None:
        """Write .ply."""
        self._core.save(os.fspath(path))

    def __repr__(self) -> str:
        return f"Sources({len(self)} waves, wavelength={format_length(self.wavelength)})"


def load_sources(path: Path, wavelength: Optional[Length] = None) -> Sources:
    """The waves of a .ply file. ``wavelength`` is for a file that states none."""
    return Sources._of(_core.load_sources(os.fspath(path), wavelength))
