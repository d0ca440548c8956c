"""Scene, and the verbs that trace it: render, focal_stack, trace, fields."""

from __future__ import annotations

import json
import os
import warnings
from typing import Any, Dict, List, Mapping, Optional, Tuple

import numpy as np

from . import _core
from ._arrays import array_of, is_array, real_numbers
from ._checked import count, table
from ._fields import Field, Path, Sources
from ._holograms import Slm
from ._images import FocalStack, Image
from ._noun import Noun
from ._parameters import refuse, takes
from ._progress import Progress, ResultWarning, watching
from ._units import Length, Lengths, Time, check_metres, format_length
from ._waves import Panel, a, panel

STAGES = ("trace", "render", "synthesize", "encode", "show", "propagate", "camera", "animate", "eye")


def _mesh(entry: Mapping[str, Any]) -> Dict[str, Any]:
    """An object of the type mesh whose arrays are given: they go into a dict of their own."""
    if entry["vertices"] is None:
        raise _core.Error('expected an array for "vertices", got None')
    if "faces" not in entry:
        raise _core.Error('expected "faces" beside the "vertices" of a mesh, which are missing')
    faces = array_of(entry["faces"], "faces")
    if faces.dtype.kind not in "iu":
        raise _core.Error(f"expected whole numbers in faces, got {faces.dtype}")
    arrays: Dict[str, Any] = {"faces": _rows(faces, "faces", np.int64)}
    for key in ("vertices", "normals", "uv", "colours"):
        if entry.get(key) is not None:
            arrays[key] = _rows(real_numbers(entry[key], key, np.float64), key, np.float64)
    rest = {key: value for key, value in entry.items() if key not in (*arrays, "normals", "uv", "colours")}
    return {**rest, "type": "mesh", "arrays": arrays}


def _points(entry: Mapping[str, Any]) -> Dict[str, Any]:
    places = _rows(real_numbers(entry["points"], "points", np.float64), "points", np.float64)
    check_metres(places, "points")
    arrays: Dict[str, Any] = {"positions": places}
    for key, default in (("amplitudes", 1.0), ("phases", 0.0)):
        given = real_numbers(entry.get(key, default), key).ravel()
        arrays[key] = np.full(len(places), given[0], np.float32) if given.size == 1 else given
    rest = {key: value for key, value in entry.items() if key not in ("points", "amplitudes", "phases")}
    return {**rest, "type": "points", "arrays": arrays}


def _rows(array: np.ndarray[Any, Any], what: str, dtype: Any) -> np.ndarray[Any, Any]:
    if array.ndim != 2:
        raise _core.Error(f"expected {what} in rows, got an array of the shape {array.shape}")
    return np.ascontiguousarray(array, dtype)


def _cells(key: str, values: Any) -> Dict[str, Any]:
    """The cells of a medium, (planes, rows, columns), as an image of the planes below each other."""
    array = array_of(values, key)
    if array.ndim != 3:
        raise _core.Error(f"expected a {key} of the shape (planes, rows, columns), got {array.shape}")
    planes, rows, columns = array.shape
    return {key: Image(array.reshape(planes * rows, columns).astype("float32")), f"{key}_planes": planes}


def _plain(value: Any) -> Any:
    """A value as the core reads it: nouns become their cores, pictures become images."""
    if isinstance(value, Mapping):
        if "vertices" in value:
            value = _mesh(value)
        elif "type" in value and "points" in value and "unit" not in value and array_of(value["points"], "points").ndim == 2:
            value = _points(value)
        for key in ("density", "temperature"):
            if is_array(value.get(key)):
                value = {**value, **_cells(key, value[key])}
        return {key: one if key == "arrays" else _plain(one) for key, one in value.items()}
    if isinstance(value, Noun):
        return value._core
    if is_array(value):
        array = array_of(value, "a scene")
        return Image(array)._core if array.ndim >= 2 else array.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    return value


class Scene(Noun):
    """The content of a scene file: geometry, lights, panel, wavelengths, and the parameters of each stage.

    ``load_scene`` reads one from a file. Here it is made from a dict, or from keywords, with the keys of a scene file
    (docs/reference/scene_format.md)::

        scene = ht.Scene(
            wavelength="532 nm",
            slm={"preset": "pluto", "columns": 960, "rows": 540},
            materials={"wood": {"texture": picture}},
            object=[
                {"type": "mesh", "vertices": v, "faces": f, "uv": uv, "material": "wood", "position": (0, 0, -0.2)},
                {"type": "points", "points": places, "amplitudes": brightness},
            ],
            light=[{"type": "point", "position": "50 50 0 mm", "intensity": 0.1}],
        )

    Lengths and angles are numbers in SI units, or texts with a unit. An array, or an Image, stands where a file names a
    picture. Objects may have arrays: ``vertices`` (n, 3) and ``faces`` (m, 3), with ``normals``, ``uv`` and ``colours``
    for each vertex; or ``points`` (n, 3), with ``amplitudes`` and ``phases``. The ``density`` and
    ``temperature`` of a medium may be arrays (planes, rows, columns) along z, y and x.

    ``time``: the time at which keys over time are read, such as ``"position": {"0 s": (0, 0, -0.3), "1 s": (0.01, 0, -0.3)}``.
    ``shutter``: how long a shutter is open from then on, ``0.02``, ``"20 ms"``, or ``"180 deg"`` of the interval 1/fps of a film. Renders, focal
    stacks and targets of holograms are means over that time; None: the shutter of the tables.
    """

    __slots__ = ()

    def __init__(
        self,
        tables: Optional[Mapping[str, Any]] = None,
        *,
        allow_outside: bool = False,
        time: Optional[Time] = None,
        shutter: Optional[Time] = None,
        **more: Any,
    ) -> None:
        if isinstance(tables, (str, os.PathLike)):
            raise _core.Error(f"expected the tables of a scene, got a path; read it with ht.load_scene({os.fspath(tables)!r})")
        given = {**table(tables, "Scene"), **more}
        slm = given.get("slm")
        if isinstance(slm, (Slm, str, os.PathLike)):
            given["slm"] = None
        self._core = _core.Job.make(_plain(given), allow_outside, time, shutter)
        if isinstance(slm, (Slm, str, os.PathLike)):
            self._core.slm = panel(slm)._core
        self.facts = {}

    @property
    def wavelengths(self) -> List[float]:
        """[m]"""
        return list(self._core.wavelengths)

    @property
    def slm(self) -> Slm:
        """The panel."""
        return Slm._of(self._core.slm)

    @property
    def warnings(self) -> List[str]:
        """Warnings about features of the files that are not shown, and about old names of keys."""
        return list(self._core.warnings)

    @property
    def time(self) -> float:
        """The time at which the scene was read [s]."""
        return float(self._core.time)

    @property
    def meshes(self) -> List[Tuple[str, np.ndarray, np.ndarray]]:
        """The name, the vertices [m] and the faces (rows of three vertices) of each mesh, at the scene's time."""
        return [(name, vertices.copy(), faces.copy()) for name, vertices, faces in self._core.meshes]

    def parameters(self, stage: str) -> Dict[str, Any]:
        """The parameters of a stage: "trace", "render", "synthesize", "encode", "show", "propagate", "camera",
        "animate" or "eye"."""
        return {one["name"]: one["value"] for one in self._core.get(stage)}

    def replace(
        self, *, wavelength: Optional[Lengths] = None, slm: Optional[Panel] = None, **stages: Mapping[str, Any]
    ) -> "Scene":
        """A scene of the same geometry with other values: ``scene.replace(trace={"paths": 16}, slm="gaea")``.

        A model keeps the size and place that it has for its first panel, which is a warning; ``load_scene(path, slm=...)``
        places it anew.
        """
        other = self.copy()
        if wavelength is not None:
            other._core.wavelengths = wavelength
        if slm is not None:
            before, other._core.slm = self.slm, panel(slm)._core
            now = other.slm
            if "model" in self.facts and (now.columns * now.pitch, now.rows * now.pitch) != (
                before.columns * before.pitch, before.rows * before.pitch
            ):
                warnings.warn(
                    "the model stays where it was placed for the panel before, and may not fit this one; to place it anew, "
                    "use ht.load_scene(path, slm=...)",
                    ResultWarning,
                    stacklevel=2,
                )
        for stage, params in stages.items():
            other._core.set(stage, table(params, stage))
        return other

    def __repr__(self) -> str:
        meshes, triangles, points, lights = self._core.counts
        colours = ", ".join(format_length(one) for one in self.wavelengths)
        return (
            f"Scene({meshes} meshes of {triangles} triangles, {points} points, {lights} lights, "
            f"{self.slm.name!r}, {colours})"
        )


def load_scene(
    path: Path,
    *,
    slm: Optional[Panel] = None,
    up: Optional[str] = None,
    rotation: Optional[str] = None,
    fit: Optional[float] = None,
    floor: Optional[str] = None,
    model_distance: Optional[Length] = None,
    model_lights: Optional[str] = None,
    model_camera: Optional[str] = None,
    series_fps: Optional[float] = None,
    turntable: Optional[Time] = None,
    allow_outside: bool = False,
    time: Optional[Time] = None,
    shutter: Optional[Time] = None,
    edits: Optional[Mapping[str, Any]] = None,
) -> Scene:
    """The scene of a file: .toml, or a model such as .glb or .obj with a panel, light and camera around it, or pictures that follow
    each other: a series such as frame_####.png, or a film.

    ``slm``: panel in place of that of the file; models are placed to fill its view (None: ``"pluto"``). For models: ``up``, the
    axis that is up in the file; ``rotation``, such as ``"y 30 deg"``; ``fit``, the part of the view that it fills; ``floor``,
    "round" or "none"; ``model_distance``, from the panel to its middle; ``model_lights``, "file", "studio" or "auto": the lamps of
    the file, two of a photographer, or those of the file if it has any; ``model_camera``, the name of a camera of the file whose
    view is shown in place of up, rotation, fit and floor; ``series_fps``, the files per second of a series of models or pictures; ``turntable``, the time in
    which it turns once about its upright axis.

    ``allow_outside``: models may name files outside their own folder. ``time``: the time at which keys over time and the
    animations of models are read; None: that of the file, or 0. ``shutter``: as for `Scene`; None: that of the file. ``edits``: values in
    place of those of the file, by their tables and keys and the numbers of lists from 1: ``{"object.2.position": "0 0 -300 mm"}``.
    """
    if isinstance(model_distance, (int, float)):
        model_distance = f"{_core.length(model_distance, 'model_distance')} m"
    if isinstance(turntable, (int, float)):
        turntable = f"{turntable} s"
    placed = {
        "up": up,
        "rotation": rotation,
        "fit": fit,
        "floor": floor,
        "model_distance": model_distance,
        "model_lights": model_lights,
        "model_camera": model_camera,
        "series_fps": series_fps,
        "turntable": turntable,
    }
    given = {key: value for key, value in placed.items() if value is not None}
    if given and not _core.is_model(os.fspath(path)):
        raise _core.Error(f"expected {next(iter(given))} with a model, got the scene {path}; place its objects by edits")
    given.update(edits or {})
    texts = {key: value if isinstance(value, str) else json.dumps(value) for key, value in given.items()}
    device = None if slm is None else panel(slm)._core
    facts = {"model": os.fspath(path)} if _core.is_model(os.fspath(path)) else None
    return Scene._of(_core.Job.load(os.fspath(path), allow_outside, time, shutter, texts, device), facts)


@takes("render", without=("focal_stack", "eye_separation"), of_scene=True)
def render(scene: Scene, *, progress: Progress = None, **params: Any) -> Image:
    """The path-traced picture of a scene, seen from the panel [W/m2/sr]."""
    refuse(params, ("focal_stack",), "use ht.focal_stack")
    refuse(params, ("eye_separation",), "use ht.render_pair")
    with watching(progress) as watch:
        core = _core.render(a(Scene, scene, "to render"), params, watch.core)
    return Image._of(core, watch.facts)


@takes("render", without=("focal_stack", "eye_separation"), of_scene=True)
def render_pair(
    scene: Scene, eye_separation: Length, *, progress: Progress = None, **params: Any
) -> Tuple[Image, Image]:
    """Pictures for the left and the right eye. The eyes are ``eye_separation`` apart, centred on ``eye``. ``ht.anaglyph`` combines both pictures into one."""
    refuse(params, ("focal_stack",), "use ht.focal_stack")
    with watching(progress) as watch:
        given = {**params, "eye_separation": eye_separation}
        left, right = _core.render_pair(a(Scene, scene, "to render"), given, watch.core)
    return Image._of(left, watch.facts), Image._of(right, watch.facts)


@takes("render", without=("columns", "rows", "field_of_view", "eye", "lens", "pupil", "focus", "focal_stack",
                          "eye_separation"), of_scene=True)
def focal_stack(scene: Scene, distances: Lengths, *, progress: Progress = None, **params: Any) -> FocalStack:
    """Path-traced pictures of a scene, one for each plane in focus, from one tracing. ``distances`` are those of the planes behind the panel; negative: in front of it."""
    with watching(progress) as watch:
        core = _core.focal_stack(a(Scene, scene, "to render"), distances, params, watch.core)
    return FocalStack._of(core, watch.facts)


@takes("trace", of_scene=True)
def trace(scene: Scene, *, progress: Progress = None, **params: Any) -> List[Sources]:
    """The waves that leave a scene, with path-traced light: one set for each wavelength, path group and light."""
    with watching(progress) as watch:
        cores = _core.trace(a(Scene, scene, "to trace"), params, watch.core)
    return [Sources._of(core, watch.facts) for core in cores]


@takes("synthesize", of_scene=True)
def fields(scene: Scene, *, frame: int = 0, progress: Progress = None, **params: Any) -> List[Field]:
    """The fields of a scene on its panel, traced and summed: one for each wavelength, path group and light.

    ``frame`` is the number of the frame whose random phases are used.
    """
    with watching(progress) as watch:
        cores = _core.fields(a(Scene, scene, "to trace"), params, count(frame, "frame", most=2**32 - 1), watch.core)
    return [Field._of(core, watch.facts) for core in cores]
