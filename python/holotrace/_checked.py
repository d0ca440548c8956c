"""Arguments of other kinds than arrays and nouns: a wrong kind is an error that names the argument."""

from __future__ import annotations

from typing import Any, Dict, Iterable, List, Mapping, Optional

from . import _core


def count(value: Any, name: str, least: int = 0, most: int = 2**31 - 1) -> int:
    """A whole number from ``least`` to ``most``."""
    whole = int(_core.count(value, name))
    if not least <= whole <= most:
        raise _core.Error(f'expected a whole number from {least} to {most} for "{name}", got {whole}')
    return whole


def number(value: Any, name: str) -> float:
    """A finite number."""
    return float(_core.number(value, name))


def text(value: Any, name: str) -> str:
    return str(_core.text(value, name))


def table(value: Optional[Mapping[str, Any]], name: str) -> Dict[str, Any]:
    """The parameters of a stage by name; None: none."""
    if value is None:
        return {}
    if not isinstance(value, Mapping):
        raise _core.Error(f'expected a dict of parameters for "{name}", got {type(value).__name__}')
    return dict(value)


def items(value: Any, what: str) -> List[Any]:
    """The items of a sequence of nouns."""
    if not isinstance(value, Iterable):
        raise _core.Error(f"expected {what}, got {type(value).__name__}")
    return list(value)
