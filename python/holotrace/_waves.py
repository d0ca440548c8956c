"""Verbs of waves: propagate, synthesize, depth_image_fields, show, expose."""

from __future__ import annotations

import os
from typing import Any, List, Mapping, Optional, Type, Union

from . import _core
from ._checked import count, table
from ._fields import Field, Path, Sources
from ._holograms import Hologram, Slm
from ._images import DepthImage, Image
from ._noun import Noun
from ._parameters import refuse, takes
from ._progress import Progress, watching
from ._units import Length, Lengths

#: A panel: an Slm, the name of a preset or a file, or a dict with the keys of a scene's ``[slm]``, such as
#: ``{"preset": "pluto", "columns": 480, "rows": 270}``.
Panel = Union[Slm, Path, Mapping[str, Any]]


def panel(given: Panel) -> Slm:
    """The panel itself."""
    if isinstance(given, Slm):
        return given
    if isinstance(given, Mapping):
        return Slm._of(_core.slm_of_table({"preset": "pluto", **given}))
    if not isinstance(given, (str, os.PathLike)):
        raise _core.Error(f"expected a panel: an Slm, its name, a file or a dict, got {type(given).__name__}")
    return Slm(given)


def a(kind: Type[Noun], given: Any, what: str) -> Any:
    """The core of a noun. A wrong kind is an error that says what was expected."""
    if isinstance(given, kind):
        return given._core
    if isinstance(given, Mapping) and kind.__name__ == "Scene":
        raise _core.Error(f"expected a Scene {what}, got {type(given).__name__}; make one with ht.Scene(tables)")
    is_array = kind is Field and not isinstance(given, Noun)
    hint = "; make one with ht.Field(array, pitch=..., wavelength=...)" if is_array else ""
    if kind.__name__ == "Sources" and not isinstance(given, Noun):
        hint = "; make one with ht.Sources(positions, wavelength=...)"
    if isinstance(given, (str, os.PathLike)) and kind.__name__ in ("Scene", "Hologram", "Field", "Image"):
        hint = f"; read one with ht.load_{kind.__name__.lower()}(path)"
    raise _core.Error(f"expected a {kind.__name__} {what}, got {type(given).__name__}{hint}")


@takes("propagate")
def propagate(field: Field, distance: Length, *, progress: Progress = None, **params: Any) -> Field:
    """The field after free space over ``distance`` along z, of either sign.

    complex64 and complex128 fields are computed in their own precision.
    """
    with watching(progress) as watch:
        core = _core.propagate(a(Field, field, "to propagate"), distance, params, watch.core)
    return Field._of(core, watch.facts)


@takes("synthesize", without=("shading", "triangle_phase"))
def synthesize(sources: Sources, slm: Panel = "pluto", *, progress: Progress = None, **params: Any) -> Field:
    """The field on the panel of spherical waves."""
    refuse(params, ("shading", "triangle_phase"), "it is for the triangles of a scene; use ht.fields")
    with watching(progress) as watch:
        core = _core.synthesize(a(Sources, sources, "to sum"), panel(slm)._core, params, watch.core)
    return Field._of(core, watch.facts)


@takes("depth_image", without=("near", "far"))
def depth_image_fields(
    image: DepthImage,
    slm: Panel = "pluto",
    *,
    wavelength: Lengths = "532 nm",
    synthesize: Optional[Mapping[str, Any]] = None,
    frame: int = 0,
    progress: Progress = None,
    **params: Any,
) -> List[Field]:
    """The fields on the panel of a picture with depths (RGB-D), one for each wavelength.

    ``synthesize`` has parameters for the sum of its slices, such as ``{"slices": 8}``. ``frame`` is the number of the
    frame whose random phases are used.
    """
    core = a(DepthImage, image, "to make a field of")
    stages = {"depth_image": params, "synthesize": table(synthesize, "synthesize")}
    with watching(progress) as watch:
        cores = _core.depth_image_fields(core, panel(slm)._core, wavelength, stages, count(frame, "frame", most=2**32 - 1), watch.core)
    return [Field._of(one, watch.facts) for one in cores]


def panel_of(hologram: Hologram, slm: Optional[Panel]) -> Slm:
    """The panel that shows a hologram."""
    if slm is not None:
        return panel(slm)
    known = hologram.slm
    rows, columns = hologram.shape
    if known is not None:
        return known
    return Slm(columns=columns, rows=rows, pitch=hologram.pitch, levels=hologram.levels, modulation=hologram.modulation)


@takes("show")
def show(hologram: Hologram, slm: Optional[Panel] = None, *, progress: Progress = None, **params: Any) -> Field:
    """The field that leaves a panel that shows a hologram.

    ``slm`` is the panel; None: the one that the hologram was made for, or an ideal one of its size.
    """
    core = a(Hologram, hologram, "to show")
    with watching(progress) as watch:
        field = _core.show(core, panel_of(hologram, slm)._core, params, watch.core)
    return Field._of(field, watch.facts)


@takes("camera", without=("distances", "exposure", "bits", "electrons", "read_noise", "noise_seed", "colours", "sweep",
                          "sweep_views", "sweep_from", "sweep_to", "sweep_seconds", "sweep_format"))
def expose(
    field: Field,
    distance: Length,
    slm: Optional[Panel] = None,
    *,
    propagate: Optional[Mapping[str, Any]] = None,
    progress: Progress = None,
    **params: Any,
) -> Image:
    """What a camera or an eye sees of a field that leaves a panel, focused at ``distance`` from it [W/m2].

    ``slm`` is the panel whose pixels the sensor has by default; None: one with the field's samples as pixels.
    ``propagate`` has parameters for the propagation to the sensor.
    """
    core = a(Field, field, "to look at").as_single()
    rows, columns = field.shape
    seen = panel(slm) if slm is not None else Slm(columns=columns, rows=rows, pitch=field.pitch)
    with watching(progress) as watch:
        image = _core.expose(core, seen._core, distance, params, table(propagate, "propagate"), watch.core)
    return Image._of(image, watch.facts)
