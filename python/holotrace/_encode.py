"""The verbs encode and run."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any, Dict, List, Mapping, Optional, Sequence, Union

import numpy as np

from . import _core
from ._arrays import array_of
from ._checked import count, table
from ._fields import Field, Path, Sources
from ._holograms import Hologram
from ._images import FocalStack, Image, LightField
from ._noun import Noun
from ._parameters import takes
from ._progress import Progress, watching
from ._scenes import Scene
from ._units import Lengths, format_length
from ._waves import Panel, a, panel

#: What a hologram is made from: the field on the panel, a target picture (also as an array), a focal stack or a light field.
Target = Union[Field, Image, FocalStack, LightField, np.ndarray[Any, Any]]

#: Nouns without a wavelength, by their names in messages.
_PICTURES = {Image: "picture", FocalStack: "focal stack", LightField: "light field"}

_WHITES = ("white", "render_white", "sweep_white", "stereo_white")


#: The holograms of the last picture of a film, in their order.
Last = Optional[Union[Hologram, Sequence[Hologram]]]


def _cores_of(last: Last) -> List[Any]:
    if last is None:
        return []
    given = [last] if isinstance(last, Noun) or not isinstance(last, Sequence) else last
    return [a(Hologram, one, "to go on from") for one in given]


def _encode(
    target: Union[Target, Sequence[Field]],
    slm: Optional[Panel],
    wavelength: Optional[Lengths],
    frames: int,
    last: Last,
    progress: Progress,
    params: Mapping[str, Any],
) -> List[Hologram]:
    before = _cores_of(last)
    if count(frames, "frames", least=1) != 1 and not isinstance(target, (FocalStack, LightField)):
        raise _core.Error("expected frames only with a focal stack or a light field; leave it out")
    if isinstance(target, (str, os.PathLike)):
        raise _core.Error(f"expected a field, a picture, a focal stack or a light field to encode, got a path; read it with ht.load_image({os.fspath(target)!r})")
    fields = isinstance(target, (list, tuple)) and any(isinstance(one, Noun) for one in target)
    is_for_pictures = wavelength is not None or params.get("target_distances") is not None
    if is_for_pictures and not isinstance(target, Noun) and not fields:
        target = Image(array_of(target, "a target picture"))
    with watching(progress, level=5) as watch:
        if isinstance(target, tuple(_PICTURES)):
            if wavelength is None:
                raise _core.Error(f"a {_PICTURES[type(target)]} has no wavelength; give its wavelength")
            device = panel(slm if slm is not None else "pluto")._core
            if isinstance(target, (FocalStack, LightField)):
                of_many = _core.encode_stack if isinstance(target, FocalStack) else _core.encode_light_field
                cores = of_many(target._core, device, wavelength, frames, before, dict(params), watch.core)
            else:
                cores = _core.encode_picture(target._core, device, wavelength, before, dict(params), watch.core)
        else:
            if wavelength is not None:
                raise _core.Error("expected a wavelength only with a picture, a focal stack or a light field; a field has its own")
            given = [target] if isinstance(target, Noun) or not isinstance(target, Sequence) else target
            single = [a(Field, one, "to encode").as_single() for one in given]
            device = None if slm is None else panel(slm)._core
            cores = _core.encode_fields(single, device, before, dict(params), watch.core)
    return [Hologram._of(core, watch.facts) for core in cores]


@takes("encode", without=("target", "quality", "planes"))
def encode(
    target: Target,
    slm: Optional[Panel] = None,
    *,
    wavelength: Optional[Lengths] = None,
    last: Optional[Hologram] = None,
    progress: Progress = None,
    **params: Any,
) -> Hologram:
    """The hologram, levels of an SLM, of a field, a target picture, a focal stack or a light field.

    ``slm`` is the panel; None: 256 levels on the field's grid, or ``"pluto"`` for the others. ``wavelength`` is
    that of a picture, a stack or a light field, which have none. Pictures are shown at ``target_distances``; an array of linear light is one,
    if a wavelength is given.

    ``last`` is the hologram of the last picture of a film: with ``method="sgd"`` the iterations go on from its levels, and need a
    fifth of their number (``next_iterations``).
    """
    holograms = _encode(target, slm, wavelength, 1, last, progress, params)
    if len(holograms) != 1:
        raise _core.Error(f"expected one wavelength for one hologram, got {len(holograms)}; use encode_all")
    return holograms[0]


@takes("encode", without=("target", "quality", "planes"))
def encode_all(
    target: Union[Target, Sequence[Field]],
    slm: Optional[Panel] = None,
    *,
    wavelength: Optional[Lengths] = None,
    frames: int = 1,
    last: Last = None,
    progress: Progress = None,
    **params: Any,
) -> List[Hologram]:
    """The holograms of several wavelengths or, of a focal stack or a light field, of several frames that are found together.

    The order is that in which they are shown: for each frame, each wavelength. ``last`` has the holograms of the last picture of a
    film in the same order: see ``encode``. With ``rolling=True`` the first frame of ``last`` is left out, the others stay, and one
    new frame follows, found for the mean light of all.
    """
    return _encode(target, slm, wavelength, frames, last, progress, params)


def _text_of(name: str, value: Any) -> str:
    """A parameter as the program's flags write it."""
    if isinstance(value, (bool, str)):
        return str(value).lower() if isinstance(value, bool) else value
    if name in ("blaze", "lens"):
        return ", ".join(one if isinstance(one, str) else format_length(float(one)) for one in np.atleast_1d(value).tolist())
    return str(value)


@takes("panel_image")
def save_panel_images(
    holograms: Union[Hologram, Sequence[Hologram]],
    path: Path,
    *,
    lut: Optional[Path] = None,
    correction: Optional[Path] = None,
    **params: Any,
) -> List[str]:
    """Write pictures as the panel of a bench wants them, and return their paths.

    ``path`` ends in .png, .bmp, .tif, .npy or .csv; several pictures become NAME, NAME_2, ... ``lut`` is the level table of the
    panel's maker, ``correction`` its phase correction, a grey picture, levels in a .csv, or radians in a .npy.
    """
    if isinstance(params.get("turn"), int):
        params["turn"] = str(params["turn"])
    cores = [a(Hologram, one, "to save") for one in ([holograms] if isinstance(holograms, Hologram) else holograms)]
    files = {"lut": lut, "correction": correction}
    names = {name: os.fspath(file) for name, file in files.items() if file is not None}
    done = {name: _text_of(name, value) for name, value in params.items()}
    done.update({name: os.path.basename(file) for name, file in names.items()})
    with watching(False) as watch:
        return list(
            _core.save_panel_images(
                cores, os.fspath(path), dict(params), names.get("lut", ""), names.get("correction", ""), done, watch.core
            )
        )


@dataclass
class Run:
    """All that the pipeline has made of a scene."""

    #: Path-traced references, and the radiance that is shown as white in them [W/m2/sr].
    renders: List[Image]
    render_white: float
    #: Waves of the first frame, one set for each wavelength, path group and light.
    sources: List[Sources]
    #: Fields on the panel in the first frame, [path group or light][wavelength].
    fields: List[List[Field]]
    #: Holograms in the order in which they are shown.
    holograms: List[Hologram]
    #: What the camera sees, one picture for each of its distances.
    views: List[Image]
    #: Irradiance that is shown as white in all views [W/m2].
    white: float
    #: For holograms for an eye: what an eye beside the eyebox sees.
    views_beside: List[Image]
    #: The views of a sweep, and their white [W/m2].
    sweep: List[Image]
    sweep_white: float
    #: Renders for the left and the right eye, and what they see of the holograms.
    stereo_renders: List[Image]
    stereo_views: List[Image]
    stereo_white: float
    #: Seconds, facts, warnings and metrics of each stage, as in report.json.
    report: Dict[str, Any]
    #: Time of the scene [s].
    time: float
    #: The core's own record of the run, from which its files follow; None after ``load_run``.
    _record: Any = field(repr=False)

    def save(self, folder: Path) -> None:
        """Write the files of ``holotrace run`` into a folder: render.png, render.exr, hologram.png, view.png, ..."""
        if self._record is None:
            raise _core.Error("expected a run that was computed here to save, got one that was loaded; copy its folder")
        made = _made_of(
            self, ("renders", "sources", "holograms", "views", "views_beside", "sweep", "stereo_renders", "stereo_views")
        )
        made.update({name: getattr(self, name) for name in _WHITES})
        with watching(False) as watch:
            _core.save_run(os.fspath(folder), made, self._record, watch.core)

    def _repr_html_(self) -> str:
        return "".join(
            [
                *(one.page(self.render_white) for one in self.renders[:1]),
                *(one._repr_html_() for one in self.holograms[:1]),
                *(one.page(self.white) for one in self.views),
            ]
        )


def run(scene: Scene, *, last: Last = None, progress: Progress = None, **stages: Mapping[str, Any]) -> Run:
    """The whole pipeline, from a scene to the camera's view of its holograms.

    Keywords are the tables of a scene file, whose values replace the scene's: ``ht.run(scene, trace={"paths": 16},
    encode={"quality": "draft"})``. ``last`` has the holograms of the last picture of a film, from which those that aim at the
    scene's light go on: see ``encode_all``.
    """
    return _run_after(None, _job_of(scene, stages), last, [], progress)


def _job_of(scene: Scene, stages: Mapping[str, Mapping[str, Any]]) -> Any:
    job = a(Scene, scene, "to run").copy()
    for stage, params in stages.items():
        if params is not None and not isinstance(params, Mapping):
            raise _core.Error(
                f'expected tables of a scene as keywords, such as encode={{"quality": "draft"}}, got {stage}={params!r}'
            )
        job.set(stage, table(params, stage))
    return job


def _run_after(earlier: Optional[Run], job: Any, last: Last, times: Sequence[float], progress: Progress) -> Run:
    """A run that takes again what an earlier one has made, if only the camera differs, and the light of a resting scene for an eye that walks, which is
    traced for its places at all these times."""
    made = record = None
    if earlier is not None:
        made, record = _made_of(earlier, ("sources", "holograms")), earlier._record
    with watching(progress) as watch:
        found = _core.run(job, _cores_of(last), made, record, list(times), watch.core)
    return _run_of(found, json.loads(found["report"]), found["record"])


def _made_of(one: Run, names: Sequence[str]) -> Dict[str, Any]:
    """What the core has made of a run: its fields, and the lists of these names."""
    made: Dict[str, Any] = {name: [item._core for item in getattr(one, name)] for name in names}
    made["fields"] = [[item._core for item in group] for group in one.fields]
    return made


def load_run(folder: Path, *, progress: Progress = None) -> Run:
    """What ``holotrace run -o FOLDER`` or ``Run.save`` wrote, as far as the files hold it.

    Holograms, fields, sources, and renders (render.exr) are as they were; a render's white is that of an automatic exposure. Pictures
    of 8 or 16 bits (views, sweep, stereo pair) are linear light relative to their white, which is 1. What the run did not make or
    write is an empty list, or an empty report.
    """
    with watching(progress) as watch:
        made = _core.load_run(os.fspath(folder), watch.core)
    path = os.path.join(folder, "report.json")
    if not os.path.exists(path):
        return _run_of(made, {}, None)
    with open(path, encoding="utf-8") as file:
        try:
            return _run_of(made, json.load(file), None)
        except ValueError as error:
            raise _core.Error(f"expected a report as JSON in {path}: {error}; run the scene again") from None


def _run_of(made: Mapping[str, Any], report: Dict[str, Any], record: Any) -> Run:
    return Run(
        **{name: made[name] for name in _WHITES},
        renders=[Image._of(core) for core in made["renders"]],
        sources=[Sources._of(core) for core in made["sources"]],
        fields=[[Field._of(core) for core in group] for group in made["fields"]],
        holograms=[Hologram._of(core) for core in made["holograms"]],
        views=[Image._of(core) for core in made["views"]],
        views_beside=[Image._of(core) for core in made["views_beside"]],
        sweep=[Image._of(core) for core in made["sweep"]],
        stereo_renders=[Image._of(core) for core in made["stereo_renders"]],
        stereo_views=[Image._of(core) for core in made["stereo_views"]],
        report=report,
        time=float(report.get("time_s", 0.0)),
        _record=record,
    )
