# The extension module: its classes and functions serve the package alone.
from typing import Any

__version__: str

class Error(ValueError):
    """The one exception of the library: what was expected, what came, where, and what to do."""

def __getattr__(name: str) -> Any: ...
