"""Slm and Hologram."""

from __future__ import annotations

import os
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from . import _core, _picture
from ._arrays import real_numbers, rows_and_columns, whole_levels
from ._checked import count, text
from ._fields import Path
from ._noun import ArrayNoun, Noun
from ._units import Length, format_length


class Slm(Noun):
    """A spatial light modulator.

    Parameters
    ----------
    name : text or dict
        A preset (``Slm.names()``), such as ``"pluto"``, or a file with the keys of a scene's ``[slm]``; or these keys as a
        dict. None, or a name of your own: a panel without effects of the given columns, rows and pitch.
    columns, rows, pitch, modulation, levels
        Size, pixel pitch, ``"phase"``, ``"amplitude"`` or ``"complex"``, and number of levels.
    others
        All other keys of ``[slm]``, such as ``fill_factor`` and ``crosstalk``. They replace those of the preset.
    """

    __slots__ = ()

    def __init__(
        self,
        name: Union[Path, Mapping[str, Any], None] = None,
        *,
        columns: Optional[int] = None,
        rows: Optional[int] = None,
        pitch: Optional[Length] = None,
        modulation: Optional[str] = None,
        levels: Optional[int] = None,
        **others: Any,
    ) -> None:
        keys = dict(others)
        for key, value in (("columns", columns), ("rows", rows), ("levels", levels)):
            if value is not None:
                keys[key] = count(value, key)
        if pitch is not None:
            keys["pitch"] = _core.length(pitch, "pitch")
        if modulation is not None:
            keys["modulation"] = text(modulation, "modulation")
        if isinstance(name, Mapping):
            core = _core.slm_of_table({**name, **keys})
        elif name is not None:
            core = self._named(os.fspath(name), keys)
        elif "preset" not in keys and (columns is None or rows is None or pitch is None):
            given = ", ".join(keys) or "none of them"
            raise _core.Error(f"expected the name of a panel, or its columns, rows and pitch, got {given}")
        else:
            core = _core.slm_of_table(keys)
        self._core = core
        self.facts = {}

    @staticmethod
    def _named(name: str, keys: Dict[str, Any]) -> Any:
        """A panel by name or file, with keys in place of its own; or an ideal one of that name, where none is known like it."""
        try:
            core = _core.Slm.load(name)
        except _core.Error as error:
            if not {"columns", "rows", "pitch"} <= set(keys) or name.endswith(".toml") or "did you mean" in str(error):
                raise
            return _core.slm_of_table({"name": name, **keys})
        if not keys:
            return core
        preset = os.path.abspath(name) if name.endswith(".toml") else name
        return _core.slm_of_table({"preset": preset, "name": core.name, **keys})

    @staticmethod
    def names() -> List[str]:
        """The names of all presets."""
        return list(_core.Slm.preset_names())

    @property
    def name(self) -> str:
        return str(self._core.name)

    @property
    def columns(self) -> int:
        return int(self._core.columns)

    @property
    def rows(self) -> int:
        return int(self._core.rows)

    @property
    def shape(self) -> Tuple[int, int]:
        """(rows, columns)"""
        return self.rows, self.columns

    @property
    def pitch(self) -> float:
        """Pixel pitch [m]."""
        return float(self._core.pitch)

    @property
    def modulation(self) -> str:
        """ "phase", "amplitude" or "complex" """
        return str(self._core.modulation)

    @property
    def levels(self) -> int:
        return int(self._core.levels)

    @property
    def fill_factor(self) -> float:
        """Lit part of a pixel's area."""
        return float(self._core.fill_factor)

    @property
    def design_wavelength(self) -> float:
        """Wavelength at which the levels show their phases [m]; 0: the one in use."""
        return float(self._core.design_wavelength)

    @property
    def phase_range(self) -> float:
        """Phase of a level after the last at the design wavelength [rad]."""
        return float(self._core.phase_range)

    @property
    def effects(self) -> List[str]:
        """Names of the differences from an ideal panel that are known."""
        return list(self._core.effects)

    def with_effects(self, names: Union[str, Sequence[str]]) -> "Slm":
        """The panel with only the named effects; "all": all of them."""
        return Slm._of(self._core.with_effects([names] if isinstance(names, str) else list(names)))

    def __repr__(self) -> str:
        return (
            f"Slm({self.name!r}, {self.columns} x {self.rows}, pitch={format_length(self.pitch)}, "
            f"{self.levels} levels of {self.modulation})"
        )


class Hologram(ArrayNoun):
    """The data shown on an SLM, a level per pixel.

    ``np.asarray(hologram)`` is the memory of the levels, not a copy; so is what other libraries take by DLPack.

    Parameters
    ----------
    level : array of the shape (ny, nx)
        Whole numbers, 0 to levels - 1, row 0 on top.
    pitch, wavelength : length
        Pixel pitch, and the wavelength that it was computed for.
    levels : whole number
        A phase level shows ``2 pi level / levels``, an amplitude level ``level / (levels - 1)``.
    modulation : "phase" or "amplitude"
    image : "virtual" or "real"
    slm : Slm
        The panel that it was made for, if it is known.
    """

    __slots__ = ()

    def __init__(
        self,
        level: Any,
        pitch: Length,
        wavelength: Length,
        *,
        levels: int = 256,
        modulation: str = "phase",
        image: str = "virtual",
        slm: Optional[Slm] = None,
    ) -> None:
        if slm is not None and not isinstance(slm, Slm):
            raise _core.Error(f"expected an Slm for the hologram's panel, got {type(slm).__name__}; make one with ht.Slm(...)")
        steps = count(levels, "levels")
        self._core = _core.Hologram.make(whole_levels(level), pitch, wavelength, steps, text(modulation, "modulation"))
        self._core.image = text(image, "image")
        self._core.slm = None if slm is None else slm._core
        self.facts = {}

    @classmethod
    def from_phase(
        cls,
        phase: Any,
        pitch: Length,
        wavelength: Length,
        *,
        levels: int = 256,
        image: str = "virtual",
        slm: Optional[Slm] = None,
    ) -> "Hologram":
        """A hologram of the nearest levels to phases in radians, such as a pattern of slmsuite or odak."""
        radians = rows_and_columns(real_numbers(phase, "phases", np.float64), "phases")
        if not np.isfinite(radians).all():
            raise _core.Error("expected finite phases, got NaN or infinity")
        steps = count(levels, "levels", least=2, most=65536)
        level = (np.rint(radians * (steps / (2 * np.pi))) % steps).astype(np.int64)
        return cls(level, pitch, wavelength, levels=levels, image=image, slm=slm)

    @property
    def level(self) -> np.ndarray[Any, Any]:
        """Levels of the shape (ny, nx), a view of the hologram's memory."""
        array: np.ndarray[Any, Any] = self._core.level
        return array

    @property
    def _values(self) -> np.ndarray[Any, Any]:
        return self.level

    @property
    def modulus_level(self) -> Optional[np.ndarray[Any, Any]]:
        """Levels of amplitude beside those of phase, on a complex panel."""
        array: Optional[np.ndarray[Any, Any]] = self._core.modulus_level
        return array

    @property
    def phase(self) -> np.ndarray[Any, Any]:
        """Phase of each pixel at the design wavelength [rad]."""
        if self.modulation == "amplitude":
            raise _core.Error("expected a hologram of phases, got one of amplitudes; use level")
        return self.level * (2 * np.pi / self.levels)

    @property
    def shape(self) -> Tuple[int, int]:
        """(ny, nx)"""
        rows, columns = self.level.shape
        return rows, columns

    @property
    def levels(self) -> int:
        """Number of levels."""
        return int(self._core.levels)

    @property
    def modulation(self) -> str:
        """ "phase", "amplitude" or "complex" """
        return str(self._core.modulation)

    @property
    def pitch(self) -> float:
        """[m]"""
        return float(self._core.pitch)

    @property
    def wavelength(self) -> float:
        """[m]"""
        return float(self._core.wavelength)

    @property
    def wavelengths(self) -> List[float]:
        """All wavelengths that it shows [m]."""
        return list(self._core.wavelengths)

    @property
    def image(self) -> str:
        """ "virtual" or "real" """
        return str(self._core.image)

    @property
    def encoder(self) -> str:
        """Method that it was made by."""
        return str(self._core.encoder)

    @property
    def illumination(self) -> float:
        """Irradiance on the panel that reproduces the brightness of the field [W/m2]."""
        return float(self._core.illumination)

    @property
    def frame(self) -> int:
        return int(self._core.frame)

    @property
    def distances(self) -> List[float]:
        """Distances from the panel to the planes in which its run focused, or that it was made for [m]; none: unknown."""
        return list(self._core.distances)

    @property
    def slm(self) -> Optional[Slm]:
        """The panel that it was made for, if it is known."""
        core = self._core.slm
        return None if core is None else Slm._of(core)

    def save(self, path: Path, **panel: Any) -> None:
        """Write the levels with their metadata: .png, .bmp or .tif of greys, .npy or .csv of levels.

        With parameters of ``save_panel_images`` (``flip``, ``turn``, ``blaze``, ``lut``, ...): the picture for a panel, which is no
        hologram any more.
        """
        if panel:
            from ._encode import save_panel_images

            save_panel_images([self], path, **panel)
        else:
            self._core.save(os.fspath(path))

    def __repr__(self) -> str:
        rows, columns = self.shape
        made = f", {self.encoder}" if self.encoder else ""
        return (
            f"Hologram({columns} x {rows}, {self.levels} levels of {self.modulation}{made}, "
            f"pitch={format_length(self.pitch)}, wavelength={format_length(self.wavelength)})"
        )

    def _repr_html_(self) -> str:
        step = -(-max(self.shape) // 384)
        grey = (self.level[::step, ::step].astype(np.float64) * (255 / (self.levels - 1))).astype(np.uint8)
        return _picture.page(repr(self), [("levels", grey)])


def load_hologram(
    path: Path,
    *,
    pitch: Optional[Length] = None,
    wavelength: Optional[Length] = None,
    levels: Optional[int] = None,
    modulation: Optional[str] = None,
    channel: Optional[str] = None,
) -> Hologram:
    """The hologram of a .png, .bmp, .tif, .csv or .npy, of this or of another program.

    Parameters
    ----------
    path : path
        A picture of greys of 8 or 16 bits; a .csv of levels; a .npy of levels or, as floats, of phases in radians (amplitudes of
        0 to 1 with ``modulation="amplitude"``).
    pitch, wavelength : length
        For a file without metadata.
    levels, modulation : whole number, "phase" or "amplitude"
        The same; None: all greys, phase.
    channel : "red", "green" or "blue"
        The channel with the hologram in a coloured picture.
    """
    core = _core.load_hologram(os.fspath(path), {"levels": levels, "modulation": modulation, "channel": channel})
    if core.pitch == 0:
        if pitch is None or wavelength is None:
            raise _core.Error(f"{path} has no metadata of a hologram; give its pitch and wavelength")
        core.pitch = pitch
    if core.wavelength == 0 and wavelength is not None:
        core.wavelength = wavelength
    return Hologram._of(core)
