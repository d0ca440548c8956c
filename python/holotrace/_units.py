"""Lengths, angles and times: numbers in SI units, or texts with a unit."""

from __future__ import annotations

from typing import Any, Sequence, Union

import numpy as np

from . import _core

#: A length in metres, or a text with its unit: 8e-6, "8 um", "300 mm".
Length = Union[float, str]
#: A wavelength may also be the name of a light: "HeNe" (:class:`Light`).
#: One length or several: 0.3, "290, 310 mm", [0.29, "310 mm"].
Lengths = Union[float, str, Sequence[Union[float, str]]]
#: An angle in radians, or a text with its unit: 0.1, "15 deg".
Angle = Union[float, str]
#: A time in seconds, or a text with its unit: 0.5, "40 ms".
Time = Union[float, str]


def check_metres(values: np.ndarray[Any, Any], name: str) -> None:
    """Bare numbers above 10 m are meant in another unit: 300 is 300 mm."""
    farthest = float(np.abs(values).max(initial=0.0))
    if 10 < farthest < float("inf"):
        raise _core.Error(
            f'expected metres for "{name}", got {farthest:g}, more than 10 m from the panel; for millimetres give {name} * 1e-3'
        )


def format_length(metres: float) -> str:
    """A length in the unit that suits it: "8 um", "300 mm"."""
    if metres == 0:
        return "0 m"
    for factor, unit in ((1.0, "m"), (1e-3, "mm"), (1e-6, "um")):
        if abs(metres) >= 0.9999 * factor:
            return f"{metres / factor:.6g} {unit}"
    return f"{metres / 1e-9:.6g} nm"
