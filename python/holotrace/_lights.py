"""Light."""

from __future__ import annotations

from typing import List

from . import _core
from ._checked import text
from ._units import format_length


class Light:
    """A laser or LED, whose name may be given wherever a wavelength is asked for.

    Parameters
    ----------
    name : text
        One of ``Light.names()``, such as ``"HeNe"``; capitals, spaces and hyphens do not matter.
    """

    __slots__ = ("name", "wavelength", "bandwidth", "source")

    def __init__(self, name: str) -> None:
        #: Name as the list has it.
        self.name: str
        #: Wavelength in air [m].
        self.wavelength: float
        #: Full width at half maximum [m], for ``bandwidth`` of ``show``; 0: too narrow to matter there.
        self.bandwidth: float
        #: Where the figures come from.
        self.source: str
        self.name, self.wavelength, self.bandwidth, self.source = _core.light(text(name, "name"))

    @staticmethod
    def names() -> List[str]:
        """The names of all lights."""
        return list(_core.light_names())

    def __repr__(self) -> str:
        return f"Light({self.name!r}, wavelength={format_length(self.wavelength)})"
