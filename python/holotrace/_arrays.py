"""Arrays that nouns are made from."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _core


#: DLPack's kinds of memory that the processor reads: its own, pinned, and managed.
_ON_HOST = (1, 3, 11, 13)


def is_array(values: Any) -> bool:
    """Whether these are an array of NumPy, or one of another library that speaks DLPack."""
    return hasattr(values, "__dlpack__")


def _on_host(tensor: Any) -> np.ndarray[Any, Any]:
    """A tensor as an array: its own memory where the processor reads it, else the copy that the tensor itself makes."""
    # PyTorch: apart from its gradient, on the host, conjugated and negated where that is pending. CuPy: get.
    for name in ("detach", "cpu", "get", "resolve_conj", "resolve_neg"):
        step = getattr(tensor, name, None)
        tensor = step() if callable(step) else tensor
    if hasattr(tensor, "__array__"):  # of NumPy, PyTorch, JAX, TensorFlow
        return np.asarray(tensor)
    if tensor.__dlpack_device__()[0] in _ON_HOST:
        return np.from_dlpack(tensor)
    return np.from_dlpack(tensor, device="cpu")  # NumPy 2.1


def array_of(values: Any, what: str) -> np.ndarray[Any, Any]:
    """The values as an array, whatever they are, and on whatever device."""
    if np.ma.is_masked(values):
        raise _core.Error(f"expected an array without masked values for {what}; fill them with .filled(0)")
    try:
        return _on_host(values) if is_array(values) else np.asarray(values)
    except (TypeError, ValueError, RuntimeError, BufferError) as error:  # rows of different lengths, a device without a copy, ...
        why = (str(error) or type(error).__name__).splitlines()[0]
        hint = "; give its values as an array of NumPy" if is_array(values) else ""
        raise _core.Error(f"expected an array for {what}: {why}{hint}") from None


def rows_and_columns(values: Any, what: str) -> np.ndarray[Any, Any]:
    """The values as an array of two dimensions."""
    array = array_of(values, what)
    if array.ndim != 2:
        raise _core.Error(f"expected {what} of the shape (rows, columns), got an array of the shape {array.shape}")
    return array


def contiguous(array: np.ndarray[Any, Any], dtype: Any) -> np.ndarray[Any, Any]:
    """The array in C order: itself if it is so already."""
    return np.ascontiguousarray(array, dtype=dtype)


def complex_samples(values: Any) -> np.ndarray[Any, Any]:
    """Complex samples in the precision that the values have. Real numbers are amplitudes with the phase 0."""
    array = rows_and_columns(values, "the samples of a field")
    if array.dtype in (np.complex64, np.float32, np.float16):
        return contiguous(array, np.complex64)
    if array.dtype in (np.complex128, np.float64):
        return contiguous(array, np.complex128)
    raise _core.Error(
        f"expected complex or real floating-point samples for a field, got {array.dtype}; convert them with"
        " astype(complex), or make a Hologram of levels"
    )


def real_numbers(values: Any, what: str, dtype: Any = np.float32) -> np.ndarray[Any, Any]:
    """Real numbers of one precision."""
    array = array_of(values, what)
    if array.dtype.kind not in "fiu":
        raise _core.Error(f"expected real numbers for {what}, got {array.dtype}")
    return contiguous(array, dtype)


def whole_levels(values: Any) -> np.ndarray[Any, Any]:
    """Levels of pixels, 0 to 65535."""
    array = rows_and_columns(values, "the levels of a hologram")
    if array.dtype.kind not in "iu":
        raise _core.Error(
            f"expected whole numbers for the levels of a hologram, got {array.dtype}; encode a field, or"
            " Hologram.from_phase for phases in radians"
        )
    if array.size > 0 and (array.min() < 0 or array.max() > 65535):
        raise _core.Error(
            f"expected levels from 0 to 65535, got {array.min() if array.min() < 0 else array.max()}"
        )
    return contiguous(array, np.uint16)
