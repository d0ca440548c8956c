"""Keyword arguments of verbs, from the library's lists of the parameters of each stage."""

from __future__ import annotations

import inspect
import textwrap
from typing import Any, Callable, Collection, Dict, List, TypeVar

from . import _core

Verb = TypeVar("Verb", bound=Callable[..., Any])

#: Stage -> its parameters, each with name, kind, value (the default), bounds, help and choices.
STAGES: Dict[str, List[Dict[str, Any]]] = _core.parameters()

_KINDS = {
    "count": "int",
    "number": "float",
    "length": "length",
    "lengths": "lengths",
    "wavelength": "wavelength",
    "angle": "angle",
    "time": "time",
    "times": "times",
    "position": "three lengths",
    "flag": "bool",
    "texts": "texts",
    "path": "path",
    "device": "device",
}


def parameters_of(stage: str, without: Collection[str] = ()) -> List[Dict[str, Any]]:
    """The parameters of a stage, except the named ones."""
    return [one for one in STAGES[stage] if one["name"] not in without]


def _section(stage: str, without: Collection[str], of_scene: bool) -> str:
    lines = []
    for one in parameters_of(stage, without):
        kind = " | ".join(f'"{name}"' for name in one["choices"]) or _KINDS[one["kind"]]
        default = f'"{one["value"]}"' if one["kind"] in ("choice", "device") else repr(one["value"])
        default = f"default: the scene's, which is {default} if it has none" if of_scene else f"default {default}"
        lines.append(f"{one['name']} : {kind}, {default}")
        bounds = f" ({one['bounds']})" if one["bounds"] else ""
        lines += textwrap.wrap(one["help"] + bounds, 100, initial_indent="    ", subsequent_indent="    ")
    return "\n".join(lines)


def takes(stage: str, *, without: Collection[str] = (), of_scene: bool = False) -> Callable[[Verb], Verb]:
    """Gives a verb with ``**params`` the parameters of a stage: in its signature and in its docstring.

    The defaults of a verb ``of_scene`` are those of its scene, and None stands for them.
    """

    def decorate(verb: Verb) -> Verb:
        signature = inspect.signature(verb)
        own = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
        named = [
            inspect.Parameter(one["name"], inspect.Parameter.KEYWORD_ONLY, default=None if of_scene else one["value"])
            for one in parameters_of(stage, without)
        ]
        verb.__signature__ = signature.replace(parameters=own + named)  # type: ignore[attr-defined]
        verb.__doc__ = inspect.cleandoc(verb.__doc__ or "") + "\n\nOther Parameters\n----------------\n" + _section(
            stage, without, of_scene
        )
        verb.__holotrace_stage__ = (stage, tuple(without), of_scene)  # type: ignore[attr-defined]
        return verb

    return decorate


def refuse(params: Dict[str, Any], names: Collection[str], instead: str) -> None:
    """Refuses parameters of a stage that have no meaning in a verb."""
    for name in names:
        if name in params:
            raise _core.Error(f'unknown parameter "{name}"; {instead}')
