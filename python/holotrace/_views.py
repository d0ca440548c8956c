"""The verbs view and anaglyph: what a camera sees of holograms."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Union

import numpy as np

from . import _core
from ._checked import items, table
from ._encode import Run
from ._fields import Path
from ._holograms import Hologram, load_hologram
from ._images import Image
from ._parameters import takes
from ._progress import Progress, watching
from ._units import Length
from ._waves import Panel, a, panel_of


@dataclass
class Views:
    """What a camera has seen of holograms, in pictures with a common exposure: a sequence of its ``images``."""

    #: One picture for each distance of the camera [W/m2].
    images: List[Image]
    #: Irradiance that is shown as white in all of them [W/m2].
    white: float
    #: The pictures of a sweep, and their white.
    sweep: List[Image]
    sweep_white: float
    #: The pictures of the left and the right eye, and their white.
    stereo: List[Image]
    stereo_white: float
    #: Seconds, facts, curves and warnings of each stage, as in report.json.
    report: Dict[str, Any]
    _record: Any = field(repr=False)

    @property
    def image(self) -> Image:
        """The picture at the first distance."""
        return self.images[0]

    def __len__(self) -> int:
        return len(self.images)

    def __getitem__(self, index: int) -> Image:
        """The picture at one of the distances, in their order."""
        return self.images[index]

    def __iter__(self) -> Iterator[Image]:
        return iter(self.images)

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> np.ndarray[Any, Any]:
        """The pictures in one array: the shape of a picture behind their number, without it if there is one picture."""
        if copy is False:
            raise ValueError("pictures of views cannot be one array without a copy; take np.asarray(views[0])")
        pixels = np.stack([np.asarray(one) for one in self.images])
        return (pixels[0] if len(self) == 1 else pixels).astype(dtype or pixels.dtype)

    def __repr__(self) -> str:
        more = [f"{len(these)} of a {name}" for name, these in (("sweep", self.sweep), ("stereo pair", self.stereo)) if these]
        return f"Views({', '.join([str(one) for one in self.images] + more)})"

    def save(self, path: Path) -> None:
        """Write the files of ``holotrace show``: NAME.png, .jpg or .exr, NAME_2, ..., with those of a sweep and a stereo pair.

        NAME.gif, .webp, .mp4 or .webm is the animation of the sweep alone, NAME_####.png its pictures alone.
        """
        made = {
            "views": [one._core for one in self.images],
            "white": self.white,
            "sweep": [one._core for one in self.sweep],
            "sweep_white": self.sweep_white,
            "stereo": [one._core for one in self.stereo],
            "stereo_white": self.stereo_white,
        }
        with watching(False) as watch:
            _core.save_views(os.fspath(path), made, self._record, watch.core)

    def _repr_html_(self) -> str:
        return "".join(one.page(self.white) for one in self.images)


def _paths_of(given: Any) -> List[str]:
    """The files of holograms that are given as a path: those of a run in place of its folder."""
    path = os.fspath(given)
    return list(_core.holograms_of_run(path)) if os.path.isdir(path) else [path]


@takes("camera")
def view(
    holograms: Union[Run, Hologram, Path, Sequence[Union[Hologram, Path]]],
    slm: Optional[Panel] = None,
    *,
    show: Optional[Mapping[str, Any]] = None,
    propagate: Optional[Mapping[str, Any]] = None,
    eye_separation: Length = 0.0,
    progress: Progress = None,
    **params: Any,
) -> Views:
    """What a camera or an eye sees of holograms on a panel: the program's ``show``.

    ``holograms`` are holograms, their files, and runs or folders of runs, which stand for all of their holograms.
    Several holograms are shown one after the other: those of one wavelength and name are averaged as frames, different
    names are added, and different wavelengths become colours. ``slm`` is the panel; None: the one that each hologram was
    made for, or an ideal one of its size. ``distances``, ``pupil`` and ``eye`` that are not given are those with which the
    first hologram's run looked at it, if it knows them. ``show`` and ``propagate`` have parameters of these verbs. An
    ``eye_separation`` adds a stereo pair, with the eyes to the left and to the right of ``eye``.
    """
    holograms = holograms.holograms if isinstance(holograms, Run) else holograms
    is_one = isinstance(holograms, (Hologram, str, os.PathLike))
    each: List[Any] = [holograms] if is_one else items(holograms, "a hologram or several to view")
    parts = [_paths_of(one) if isinstance(one, (str, os.PathLike)) else [one] for one in each]
    _core.check_series([one for part in parts for one in part if isinstance(one, str)])
    given = [load_hologram(one) if isinstance(one, str) else one for part in parts for one in part]
    cores = [a(Hologram, one, "to view") for one in given]
    panels = [panel_of(one, slm)._core for one in given]
    stages = {"show": table(show, "show"), "propagate": table(propagate, "propagate"), "camera": params}
    with watching(progress) as watch:
        made = _core.view(cores, panels, stages, eye_separation, watch.core)
    return Views(
        images=[Image._of(core, watch.facts) for core in made["views"]],
        white=made["white"],
        sweep=[Image._of(core) for core in made["sweep"]],
        sweep_white=made["sweep_white"],
        stereo=[Image._of(core) for core in made["stereo"]],
        stereo_white=made["stereo_white"],
        report=json.loads(made["report"]),
        _record=made["record"],
    )


def anaglyph(left: Image, right: Image) -> Image:
    """Both pictures of a stereo pair in one, for glasses with red before the left eye and cyan before the right."""
    return Image._of(_core.anaglyph(a(Image, left, "of the left eye"), a(Image, right, "of the right eye")))
