"""What all nouns have in common."""

from __future__ import annotations

from typing import Any, Dict, Mapping, Optional, Tuple, Type, TypeVar, Union

import numpy as np

Fact = Union[int, float, str]
Self = TypeVar("Self", bound="Noun")


class Noun:
    """An object of the library, with the facts that the verb which made it has stated."""

    __slots__ = ("_core", "facts", "__weakref__")
    _core: Any
    #: Counts, figures and choices of the verb that made it, as in the program's reports.
    facts: Dict[str, Fact]

    @classmethod
    def _of(cls: Type[Self], core: Any, facts: Optional[Mapping[str, Fact]] = None) -> Self:
        noun = cls.__new__(cls)
        noun._core = core
        noun.facts = dict(facts or {})
        return noun

    def copy(self: Self) -> Self:
        """A copy with memory of its own."""
        return self._of(self._core.copy(), self.facts)

    def __copy__(self: Self) -> Self:
        return self.copy()

    def __deepcopy__(self: Self, memo: Any) -> Self:
        return self.copy()

    def __reduce__(self) -> Any:
        return (self._of, (self._core, self.facts))


class ArrayNoun(Noun):
    """A noun whose values are an array, for NumPy and for every library that speaks DLPack.

    ``np.asarray``, ``torch.from_dlpack`` and ``jax.dlpack.from_dlpack`` see the memory of the noun itself, not a copy.
    """

    __slots__ = ()

    @property
    def _values(self) -> np.ndarray[Any, Any]:
        raise NotImplementedError

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> np.ndarray[Any, Any]:
        array = self._values if dtype is None else self._values.astype(dtype, copy=False)
        return array.copy() if copy else array

    def __dlpack__(self, **wanted: Any) -> Any:
        return self._values.__dlpack__(**wanted)

    def __dlpack_device__(self) -> Tuple[Any, Any]:
        return self._values.__dlpack_device__()
