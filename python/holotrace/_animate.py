"""The verb animate, and files of films."""

from __future__ import annotations

import os
from typing import Any, Callable, Iterator, Mapping, Optional, Sequence, Union

from . import _core
from ._checked import items
from ._encode import Run, _job_of, _run_after
from ._fields import Path
from ._images import Image
from ._parameters import takes
from ._progress import Progress
from ._scenes import Scene, load_scene
from ._units import Time
from ._views import Views

#: What moves: a scene file or a model, the tables of a scene with keys over time, or a function that gives the scene, or its tables, at a time [s].
Moving = Union[Path, Mapping[str, Any], Callable[[float], Union[Scene, Mapping[str, Any]]]]


def _at(moving: Moving, allow_outside: bool) -> Callable[[Any, Any], Scene]:
    if isinstance(moving, (str, os.PathLike)):
        path: Path = moving
        return lambda time, shutter: load_scene(path, allow_outside=allow_outside, time=time, shutter=shutter)
    if isinstance(moving, Mapping):
        tables = moving
        return lambda time, shutter: Scene(tables, allow_outside=allow_outside, time=time, shutter=shutter)
    if isinstance(moving, Scene) or not callable(moving):
        raise _core.Error(
            f"expected what moves: a path, the tables of a scene, or a function of time, got {type(moving).__name__}; "
            "a Scene is one of one time"
        )
    function = moving

    def still_at(time: float) -> Scene:
        scene = function(time)
        if isinstance(scene, Mapping):
            return Scene(scene, allow_outside=allow_outside, time=time)
        if not isinstance(scene, Scene):
            raise _core.Error(f"expected a Scene, or its tables, at {time:g} s, got {type(scene).__name__}")
        scene = scene.copy()
        scene._core.move_eye(time)
        return scene

    def scene_at(time: Any, shutter: Any) -> Scene:
        time = 0.0 if time is None else time
        scene = still_at(time)
        if not shutter:
            return scene
        return Scene._of(scene._core.open_shutter(shutter, lambda later: still_at(time - scene.time + later)._core))

    return scene_at


@takes("animate", without=("format",), of_scene=True)
def animate(
    moving: Moving,
    *,
    stages: Optional[Mapping[str, Mapping[str, Any]]] = None,
    allow_outside: bool = False,
    shutter: Optional[Time] = None,
    progress: Progress = None,
    **params: Any,
) -> Iterator[Run]:
    """The holograms of a scene at several times, one after the other: a `Run` for each, with its ``time``.

    ``moving`` is a scene file or a model, the tables of a scene (see `Scene`) with keys over time, or a function that gives the
    scene at a time in seconds. ``stages`` are tables whose values replace the scene's, as those of `run`::

        for one in ht.animate("chess.toml", seconds=2, fps=25, stages={"trace": {"paths": 16}}):
            one.holograms[0].save(f"hologram_{one.time:.3f}.png")

    A function also takes what `load_scene` takes, such as a turntable and another panel::

        ht.animate(lambda t: ht.load_scene("teapot.obj", slm="pluto", turntable="4 s", time=t), seconds=4, fps=10)

    ``shutter``: how long the shutter of each time is open, as `Scene` takes it, at most 1/fps, for which its holograms are shown. A camera with a
    longer exposure sees the mean of the views of several times.

    A viewer who walks has ``stages={"eye": {"track": "walk.csv", "latency": "20 ms"}}``: the holograms are for the measured eye, the
    views and renders those of the eye itself. Each `Run` is that of `run` for the scene at that time; holograms of waves are taken again where
    only the camera moves. With ``from_last=True`` holograms that aim at the scene's light go on from those of the time before.
    ``holotrace animate`` writes films of all times, and resumes.
    """
    scene_at = _at(moving, allow_outside)
    tables = stages or {}
    first = scene_at(None, 0.0).replace(**tables)
    times, from_last, opened = first._core.times(params, shutter)
    if first.parameters("eye")["track"]:
        scene_at(times[-1], 0.0).replace(**tables)  # a track that ends before is an error at once

    def runs() -> Iterator[Run]:
        first_job, before = None, None
        for time in times:
            job = _job_of(scene_at(time, opened), tables)
            first_job = first_job or job
            _core.check_time_of_film(job, first_job, from_last)
            last = before.holograms if before and from_last else None
            before = _run_after(before, job, last, times if from_last else [], progress)
            before.time = time
            yield before

    return runs()


def save_film(path: Path, images: Sequence[Union[Image, Views]], *, fps: float = 25, white: float = 1) -> None:
    """Write pictures as a film: .webp, .gif, or, with the program ffmpeg, .mp4 and .webm.

    ``white`` is the value that is shown as white. Pictures wider than 960 pixels are averaged down to that.
    Of `Views` it takes the picture at the first distance.
    """
    cores = []
    for one in items(images, "pictures of a film"):
        if isinstance(one, (list, tuple)) and len(one) > 0 and isinstance(one[0], Image):
            raise _core.Error("expected one picture for each moment of the film, got a list of views; take the first, run.views[0]")
        picture = one.image if isinstance(one, Views) else one
        cores.append((picture if isinstance(picture, Image) else Image(picture))._core)
    _core.save_film(os.fspath(path), cores, float(fps), float(white))
