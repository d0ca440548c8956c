"""What holotrace.torch and holotrace.jax have in common."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Tuple

import numpy as np

from . import _core
from ._units import Length, Lengths

Shape = Tuple[int, int]

#: The core's operators of free space by the precision of their samples.
SPACES = {np.dtype(np.complex64): _core.Propagation32, np.dtype(np.complex128): _core.Propagation64}


def camera_path(
    shape: Shape, pitch: Length, distance: Length, image: str, pupil: Length, eye: Lengths
) -> Tuple[List[Dict[str, Any]], Optional[np.ndarray[Any, Any]]]:
    """How light comes from a panel to the plane in focus: the arguments of one or two propagations, and the pupil.

    With a pupil, the first propagation ends in a window about it, whose samples lie on the panel's own lattice.
    """
    if image not in ("virtual", "real"):
        raise _core.Error(f'expected the image "virtual" or "real", got "{image}"')
    metres = _core.length(distance, "distance")
    z = -metres if image == "virtual" else metres
    diameter, step = _core.length(pupil, "pupil"), _core.length(pitch, "pitch")
    if diameter <= 0:
        return [{"shape": shape, "distance": z}], None
    x, y, eye_z = _core.position(eye, "eye")
    samples = int(np.ceil(diameter / step)) + 2
    columns, rows = samples + (samples + shape[1]) % 2, samples + (samples + shape[0]) % 2
    centre = (round(x / step) * step, round(y / step) * step)
    to_eye = {"shape": shape, "distance": eye_z, "columns": columns, "rows": rows, "centre_x": centre[0], "centre_y": centre[1]}
    back = {
        "shape": (rows, columns), "distance": z - eye_z, "columns": shape[1], "rows": shape[0],
        "centre_x": -centre[0], "centre_y": -centre[1],
    }
    across = (np.arange(columns) - (columns - 1) / 2) * step + centre[0] - x
    down = ((rows - 1) / 2 - np.arange(rows)) * step + centre[1] - y
    mask: np.ndarray[Any, Any] = np.hypot(across, down[:, None]) <= diameter / 2
    return [to_eye, back], mask
