"""The verbs compare, limits, estimate and calibrate."""

from __future__ import annotations

import json
import os
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

from . import _core
from ._fields import Field, Path
from ._holograms import Hologram, Slm
from ._images import Image
from ._noun import Noun
from ._parameters import takes
from ._progress import Progress, watching
from ._scenes import Scene
from ._units import Length, Lengths, format_length
from ._waves import Panel, a, panel


def compare(reference: Union[Image, Field], other: Union[Image, Field]) -> Dict[str, Any]:
    """How an image or a field differs from its reference.

    Images: ``psnr`` and ``psnr_unscaled`` [dB], ``psnr_amplitude`` [dB], ``ssim``, ``ssim_unscaled``, ``scale``,
    ``rms_error``, ``speckle_contrast``, ``bright_fraction``, ``power_ratio``, ``uniformity``. Fields:
    ``relative_error``, ``scaled_error``, ``scale``, ``correlation``. Of an image in colour and a grey one, such as a render and
    a view of one wavelength, the luminances are compared. Figures in a report of ``run`` may be better: they leave out the noise
    of its render.
    """
    if isinstance(reference, Image) and isinstance(other, Image):
        return dict(_core.compare_images(reference._core, other._core))
    if isinstance(reference, Field) and isinstance(other, Field):
        return dict(_core.compare_fields(reference._core.as_double(), other._core.as_double()))
    raise _core.Error(
        f"expected two images or two fields to compare, got {type(reference).__name__} and {type(other).__name__}; "
        "a picture in an array becomes one by ht.Image(array)"
    )


@takes("register")
def register(
    photograph: Image, simulation: Image, *, progress: Progress = None, **params: Any
) -> Tuple[Image, Dict[str, Any]]:
    """A photograph laid onto the pixels of its simulation, and how the two differ.

    The figures are those of ``compare`` over the pixels that the photograph covers, and the pose: ``magnification``,
    ``rotation`` [rad], ``shift_x_pixels``, ``shift_y_pixels``, ``gain``, ``offset``, ``place_error_pixels``,
    ``correlation``, ``overlap``, ``residual`` and ``compared_columns``, ``compared_rows``, ``compared_first_column``,
    ``compared_first_row``.
    """
    cores = a(Image, photograph, "to register"), a(Image, simulation, "to register it to")
    with watching(progress) as watch:
        core, figures = _core.register_image(*cores, params, watch.core)
    return Image._of(core, watch.facts), dict(figures)


def usual_light(slm: Slm) -> Length:
    """The wavelength that a panel is made for, if it is known, else that of a helium-neon laser [m]."""
    return float(slm._core.usual_wavelength)


def limits(
    slm: Panel = "pluto",
    *,
    wavelength: Optional[Lengths] = None,
    distance: Length = "300 mm",
    scene: Optional[Scene] = None,
) -> Dict[str, Any]:
    """What a panel can show at a distance: angles, resolution, depth of focus, eyebox, alias-free and replica-free sizes.

    All figures are in SI units and degrees, by the names that ``holotrace limits --json`` has. ``wavelength`` is by default the
    panel's design wavelength, if it has one, else 632.8 nm.
    """
    core = None if scene is None else a(Scene, scene, "")
    shown = panel(slm)
    wavelength = usual_light(shown) if wavelength is None else wavelength
    figures: Dict[str, Any] = json.loads(_core.limits(shown._core, wavelength, distance, core))
    return figures


def estimate(scene: Scene, *, frames_per_second: float = 30.0, progress: Progress = None) -> Dict[str, Any]:
    """The predicted time of ``run`` on this machine, stage by stage, from short probes.

    The figures have the names of ``holotrace estimate --json``.
    """
    with watching(progress) as watch:
        figures: Dict[str, Any] = json.loads(
            _core.estimate(a(Scene, scene, "to estimate"), frames_per_second, watch.core)
        )
    return figures


class CalibrationPlan(Noun):
    """Test patterns to show on a panel and to photograph.

    Parameters are those of ``calibration_patterns``, which makes a plan.
    """

    __slots__ = ()

    @property
    def distance(self) -> float:
        """From the panel to the camera's bare sensor [m]."""
        return float(self._core.distance)

    @property
    def names(self) -> List[str]:
        return list(self._core.names)

    @property
    def holograms(self) -> List[Hologram]:
        """The patterns, in the order of their names."""
        return [Hologram._of(core) for core in self._core.holograms]

    def save(self, folder: Path) -> None:
        """Write the patterns and calibration.toml into a folder."""
        self._core.save(os.fspath(folder))

    def load_photographs(self, folder: Path) -> List[Image]:
        """The photographs of the patterns, each named as its pattern."""
        return [Image._of(core) for core in self._core.photographs(os.fspath(folder))]

    def __repr__(self) -> str:
        return f"CalibrationPlan({len(self.names)} patterns, distance={format_length(self.distance)})"


def load_calibration_plan(path: Path) -> CalibrationPlan:
    """The plan that ``CalibrationPlan.save`` or ``holotrace calibrate patterns`` wrote."""
    return CalibrationPlan._of(_core.CalibrationPlan.load(os.fspath(path)))


@takes("patterns")
def calibration_patterns(
    slm: Panel = "pluto", *, wavelength: Optional[Length] = None, distance: Length = "300 mm", **params: Any
) -> CalibrationPlan:
    """Test patterns that measure a panel, which is assumed to be ``slm``.

    ``wavelength`` is by default the panel's design wavelength, if it has one, else 632.8 nm.
    """
    assumed = panel(slm)
    wavelength = usual_light(assumed) if wavelength is None else wavelength
    return CalibrationPlan._of(_core.CalibrationPlan.make(assumed._core, wavelength, distance, params))


@takes("calibrate")
def calibrate(
    plan: CalibrationPlan, photographs: Sequence[Image], *, progress: Progress = None, **params: Any
) -> Tuple[Slm, Dict[str, Any]]:
    """The panel that explains the photographs of test patterns best, and the figures of the fit."""
    cores = [a(Image, one, "of each pattern") for one in photographs]
    with watching(progress) as watch:
        core, figures = _core.calibrate(a(CalibrationPlan, plan, "to fit"), cores, params, watch.core)
    return Slm._of(core, watch.facts), json.loads(figures)
