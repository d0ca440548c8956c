"""Writes the type stubs of the verbs, from their signatures and the library's lists of parameters.

usage: make_stubs.py FOLDER     FOLDER has the package holotrace, and receives holotrace/NAME.pyi

The modules of the verbs take ``**params``; their stubs name each parameter with its type. All other modules are typed in
their own source.
"""

import importlib
import inspect
import re
import sys
from pathlib import Path

folder = Path(sys.argv[1])
sys.path.insert(0, str(folder))
parameters = importlib.import_module("holotrace._parameters")

TYPES = {
    "count": "int",
    "number": "float",
    "length": "Length",
    "lengths": "Lengths",
    "wavelength": "Length",
    "angle": "Angle",
    "position": "Lengths",
    "flag": "bool",
    "texts": "Union[str, Sequence[str]]",
    "device": "str",
}


def type_of(one):
    names = ", ".join(f'"{name}"' for name in one["choices"])
    return f"Literal[{names}]" if names else TYPES[one["kind"]]


def stub_of(verb):
    stage, without, of_scene = verb.__holotrace_stage__
    own = []
    for parameter in inspect.signature(verb).parameters.values():
        if any(parameter.name == one["name"] for one in parameters.parameters_of(stage, without)):
            continue
        default = "" if parameter.default is parameter.empty else " = ..."
        if parameter.kind is parameter.KEYWORD_ONLY and "*" not in own:
            own.append("*")
        own.append(f"{parameter.name}: {parameter.annotation}{default}")
    if "*" not in own:
        own.append("*")
    for one in parameters.parameters_of(stage, without):
        kind = f"Optional[{type_of(one)}]" if of_scene else type_of(one)
        own.append(f"{one['name']}: {kind} = ...")
    joined = ",\n    ".join(own)
    returns = inspect.signature(verb).return_annotation
    return f"def {verb.__name__}(\n    {joined},\n) -> {returns}: ...\n"


def stub_of_module(name):
    """The module's source with the bodies of its verbs replaced: what else it defines is typed in the source itself."""
    module = importlib.import_module(f"holotrace.{name}")
    source = Path(module.__file__).read_text(encoding="utf-8")
    verbs = {key: value for key, value in vars(module).items()
             if hasattr(value, "__holotrace_stage__") and value.__module__ == module.__name__}
    for key, verb in verbs.items():
        pattern = re.compile(rf'^@takes\((?:.|\n)*?^def {key}\((?:.|\n)*?(?=^(?:def|class|@|#|[A-Z])|\Z)', re.MULTILINE)
        source, count = pattern.subn(lambda _: stub_of(verb) + "\n\n", source)
        assert count == 1, (name, key)
    head = "from typing import Literal, Optional, Sequence, Union\n\nfrom ._units import Angle, Length, Lengths\n"
    return "# Made by python/make_stubs.py from the library's lists of parameters.\n" + source.replace(
        "from __future__ import annotations\n", "from __future__ import annotations\n\n" + head, 1
    )


for name in ("_waves", "_scenes", "_encode", "_figures", "_views"):
    path = folder / "holotrace" / f"{name}.pyi"
    path.write_text(stub_of_module(name), encoding="utf-8")
