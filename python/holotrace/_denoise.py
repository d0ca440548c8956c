"""denoise: pictures without the noise of few light paths."""

from __future__ import annotations

import importlib.util
import pathlib
from typing import Optional

from . import _core
from ._images import Image
from ._progress import Progress, watching
from ._waves import a


def _name_library() -> None:
    """Let the program find Open Image Denoise in the package pyoidn, without importing that."""
    package = importlib.util.find_spec("pyoidn")
    for folder in (package.submodule_search_locations or ()) if package else ():
        _core.look_for_denoiser_in(str(pathlib.Path(folder) / "oidn" / "lib"))


_name_library()


def denoise(
    image: Image,
    albedo: Optional[Image] = None,
    normals: Optional[Image] = None,
    *,
    fast: bool = False,
    progress: Progress = None,
) -> Image:
    """The picture without the noise of few light paths, by Open Image Denoise 2 (``pip install holotrace[denoise]``).

    Means over regions stay those of the light paths; details are estimates. Do not measure with it.

    Parameters
    ----------
    image : Image
        Linear light of 0 or more, one channel or three.
    albedo, normals : Image
        What the picture's surfaces look like, three channels each, both or none: the fraction of light that they
        reflect, and their unit normals.
    fast : bool
        Half the time, with 0.2 to 0.7 dB more error.
    """
    guides = [None if guide is None else a(Image, guide, "as a guide") for guide in (albedo, normals)]
    with watching(progress) as watch:
        core = _core.denoise(a(Image, image, "to denoise"), *guides, bool(fast), watch.core)
    return Image._of(core, watch.facts)
