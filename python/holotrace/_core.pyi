# The extension module: its classes and functions serve the package alone.
from typing import Any

__version__: str

class Error(ValueError):
    """The one exception of the library: what was expected, what came, where, and what to do."""

def set_threads(count: int) -> None:
    """The number of threads that verbs use; 0: all. Results do not depend on it."""

def __getattr__(name: str) -> Any: ...
