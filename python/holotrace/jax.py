"""Light through free space and panel in JAX, with the library's analytic adjoints::

    import jax, jax.numpy as jnp, holotrace.jax as htj

    to_plane = htj.Propagation((1080, 1920), "8 um", "632.8 nm", "-100 mm")
    loss = lambda phase: ((jnp.abs(to_plane(jnp.exp(1j * phase))) - target) ** 2).mean()
    gradient = jax.jit(jax.grad(loss))(phase)

Functions work under ``jit``, ``grad`` and ``vmap``. Arrays may be on any device: the work is done on the CPU, and results and
gradients return to the array's device. Gradients are those of JAX: dL/dRe - i dL/dIm of a
complex array. Propagation has the precision of its array: complex64, or complex128 with ``jax_enable_x64``; the panel
computes in single precision.
"""

from __future__ import annotations

from functools import partial
from typing import Any, Callable, Dict, Tuple

import jax
import jax.numpy as jnp
import numpy as np

from . import _core
from ._differentiable import SPACES, Shape, camera_path
from ._holograms import Slm
from ._units import Length, Lengths
from ._waves import Panel, panel

__all__ = ["Camera", "Modulator", "Propagation", "camera", "propagate", "round_levels", "slm"]


def _each(function: Callable[..., Any], *arrays: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Applies a function of arrays of rows and columns to each of a batch."""
    batch = arrays[0].shape[:-2]
    flat = [array.reshape((-1,) + array.shape[-2:]) for array in arrays]
    made = np.stack([function(*map(np.ascontiguousarray, items)) for items in zip(*flat)])
    shaped: np.ndarray[Any, Any] = made.reshape(batch + made.shape[-2:])
    return shaped


def _call(function: Callable[..., Any], shape: Shape, dtype: Any, *arrays: Any) -> Any:
    """A function of NumPy arrays inside JAX."""
    made = jax.ShapeDtypeStruct(arrays[0].shape[:-2] + shape, dtype)
    work = lambda *given: _each(function, *map(np.asarray, given)).astype(dtype, copy=False)  # noqa: E731
    return jax.pure_callback(work, made, *arrays, vmap_method="broadcast_all")


# T, and its transpose conj(T^H conj(u)), which JAX pulls cotangents back with. Each is the other's gradient.
@partial(jax.custom_vjp, nondiff_argnums=(0, 1))
def _apply(space: "Propagation", is_transposed: bool, u: Any) -> Any:
    core = space._core(u.dtype)
    if is_transposed:
        return _call(lambda v: np.conj(core.adjoint(np.conj(v))), space.shape, u.dtype, u)
    return _call(core.apply, core.output_shape, u.dtype, u)


def _apply_forward(space: "Propagation", is_transposed: bool, u: Any) -> Tuple[Any, None]:
    return _apply(space, is_transposed, u), None


def _apply_backward(space: "Propagation", is_transposed: bool, kept: None, cotangent: Any) -> Tuple[Any]:
    return (_apply(space, not is_transposed, cotangent),)


_apply.defvjp(_apply_forward, _apply_backward)


class Propagation:
    """Free space over one distance, prepared for any number of arrays: a callable of (..., ny, nx) arrays.

    Parameters are those of ``ht.propagate``, on the processor; the output has the input's pitch.
    """

    def __init__(self, shape: Shape, pitch: Length, wavelength: Length, distance: Length, **params: Any) -> None:
        self.shape: Shape = (int(shape[0]), int(shape[1]))
        self._arguments = (*self.shape, pitch, wavelength, distance, params)
        self._cores: Dict[Any, Any] = {}

    def _core(self, dtype: Any) -> Any:
        kind = np.dtype(dtype)
        if kind not in self._cores:
            if kind not in SPACES:
                raise _core.Error(f"expected a complex64 or complex128 array, got {kind}")
            self._cores[kind] = SPACES[kind](*self._arguments)
        return self._cores[kind]

    def __call__(self, u: Any) -> Any:
        u = jnp.asarray(u)
        if u.shape[-2:] != self.shape:
            raise _core.Error(f"expected samples of the shape (..., {self.shape[0]}, {self.shape[1]}), got {u.shape}")
        return _apply(self, False, u)


def propagate(u: Any, distance: Length, *, pitch: Length, wavelength: Length, **params: Any) -> Any:
    """A field of samples (..., ny, nx) after free space over ``distance``. For many calls, make a ``Propagation``."""
    if np.ndim(u) < 2:
        raise _core.Error(f"expected an array of the shape (..., rows, columns), got {np.shape(u)}")
    rows, columns = np.shape(u)[-2:]
    return Propagation((rows, columns), pitch, wavelength, distance, **params)(u)


@partial(jax.custom_vjp, nondiff_argnums=(0,))
def _leave(modulator: "Modulator", level: Any) -> Any:
    return _call(modulator._core.leave, modulator._shown, np.complex64, level)


def _leave_forward(modulator: "Modulator", level: Any) -> Tuple[Any, Any]:
    return _leave(modulator, level), level


def _leave_backward(modulator: "Modulator", level: Any, cotangent: Any) -> Tuple[Any]:
    pull_back = lambda given, light: modulator._core.pull_back(given, np.conj(light))  # noqa: E731
    return (_call(pull_back, modulator.slm.shape, np.float32, level, cotangent),)


_leave.defvjp(_leave_forward, _leave_backward)


class Modulator:
    """A panel: a callable of levels (..., ny, nx), not rounded, to the field that leaves it, as ``ht.show``.

    Between whole levels the calibration is linear. ``params`` are those of ``ht.show``: subpixels, effects, irradiance,
    light, tilts.
    """

    def __init__(self, slm: Panel, wavelength: Length, **params: Any) -> None:
        self.slm: Slm = panel(slm)
        self._core = _core.Panel(self.slm._core, wavelength, params)
        rows, columns = self._core.leave(np.zeros(self.slm.shape, np.float32)).shape
        self._shown: Shape = (rows, columns)

    def __call__(self, level: Any) -> Any:
        level = jnp.asarray(level)
        if level.shape[-2:] != self.slm.shape:
            rows, columns = self.slm.shape
            raise _core.Error(f"expected levels of the shape (..., {rows}, {columns}), got {level.shape}")
        return _leave(self, level.astype(np.float32))

    def of_phase(self, phase: Any) -> Any:
        """The field for phases in radians at the design wavelength, of a panel whose levels are even steps of a turn."""
        levels = self.slm.levels
        return self(jnp.remainder(phase * (levels / (2 * np.pi)), levels))


def slm(level: Any, slm: Panel, *, wavelength: Length, **params: Any) -> Any:
    """The field that leaves a panel that is driven with levels. For many calls, make a ``Modulator``."""
    return Modulator(slm, wavelength, **params)(level)


def round_levels(level: Any) -> Any:
    """Whole levels; the gradient passes as if they were not rounded (the straight-through estimator)."""
    return level + jax.lax.stop_gradient(jnp.round(level) - level)


class Camera:
    """The irradiance that a lensless sensor, or an eye, sees of the light that leaves a panel: a callable.

    Parameters are those of ``holotrace.torch.Camera``.
    """

    def __init__(
        self,
        shape: Shape,
        pitch: Length,
        wavelength: Length,
        distance: Length,
        *,
        image: str = "virtual",
        pupil: Length = 0.0,
        eye: Lengths = (0.0, 0.0, 0.0),
        binning: int = 1,
    ) -> None:
        steps, self._mask = camera_path(shape, pitch, distance, image, pupil, eye)
        self._steps = [Propagation(pitch=pitch, wavelength=wavelength, **step) for step in steps]
        self._binning = binning

    def __call__(self, u: Any) -> Any:
        field = self._steps[0](u)
        if self._mask is not None:
            field = self._steps[1](field * self._mask)
        irradiance = field.real**2 + field.imag**2
        n = self._binning
        if n == 1:
            return irradiance
        rows, columns = irradiance.shape[-2] // n, irradiance.shape[-1] // n
        cut = irradiance[..., : rows * n, : columns * n]
        return cut.reshape(cut.shape[:-2] + (rows, n, columns, n)).mean(axis=(-3, -1))


def camera(u: Any, distance: Length, *, pitch: Length, wavelength: Length, **params: Any) -> Any:
    """What a camera sees of a field of samples (..., ny, nx). For many calls, make a ``Camera``."""
    rows, columns = np.shape(u)[-2:]
    return Camera((rows, columns), pitch, wavelength, distance, **params)(u)
