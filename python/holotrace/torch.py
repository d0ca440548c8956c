"""Light through free space, panel and camera in PyTorch, with the library's analytic adjoints::

    import torch, holotrace.torch as htt

    to_plane = htt.Propagation((1080, 1920), "8 um", "632.8 nm", "-100 mm")
    phase = torch.rand(1080, 1920, requires_grad=True)
    loss = ((to_plane(torch.polar(torch.ones_like(phase), phase)).abs() - target) ** 2).mean()
    loss.backward()

Tensors may be on any device: the work is done on the CPU, and results and gradients return to the tensor's device. Gradients
are those of torch: dL/dRe + i dL/dIm of a complex tensor. Propagation has the precision of its tensor, complex64 or
complex128; the panel computes in single precision.
"""

from __future__ import annotations

from typing import Any, Dict, Optional, Tuple

import numpy as np
import torch

from . import _core
from ._arrays import array_of
from ._differentiable import camera_path
from ._holograms import Slm
from ._units import Length, Lengths
from ._waves import Panel, panel

__all__ = ["Camera", "Modulator", "Propagation", "camera", "propagate", "round_levels", "slm"]


def _each(function: Any, tensor: torch.Tensor, dtype: torch.dtype, *more: torch.Tensor) -> torch.Tensor:
    """Applies a function of arrays of rows and columns to each of a batch. The result is on the device of the tensor."""
    if tensor.ndim < 2:
        raise _core.Error(f"expected a tensor of the shape (..., rows, columns), got {tuple(tensor.shape)}")
    arrays = [
        np.ascontiguousarray(array_of(one.to(kind), "the values of a tensor"))
        for one, kind in zip((tensor, *more), (dtype, torch.complex64))
    ]
    if tensor.ndim == 2:
        return torch.from_numpy(function(*arrays)).to(tensor.device)
    flat = [array.reshape((-1,) + array.shape[-2:]) for array in arrays]
    stack = torch.from_numpy(np.stack([function(*items) for items in zip(*flat)]))
    return stack.reshape(tensor.shape[:-2] + stack.shape[-2:]).to(tensor.device)


class _Apply(torch.autograd.Function):
    """T and its adjoint. The gradient of a gradient is the same pair the other way round."""

    @staticmethod
    def forward(ctx: Any, u: torch.Tensor, core: Any, is_adjoint: bool) -> torch.Tensor:
        ctx.core, ctx.is_adjoint = core, is_adjoint
        return _each(core.adjoint if is_adjoint else core.apply, u, u.dtype)

    @staticmethod
    def backward(ctx: Any, *gradients: torch.Tensor) -> Any:
        (gradient,) = gradients
        return _Apply.apply(gradient, ctx.core, not ctx.is_adjoint), None, None


class Propagation:
    """Free space over one distance, prepared for any number of tensors: a callable of (..., ny, nx) tensors.

    Parameters are those of ``ht.propagate``, on the processor; the output has the input's pitch.
    """

    def __init__(
        self, shape: Tuple[int, int], pitch: Length, wavelength: Length, distance: Length, **params: Any
    ) -> None:
        self._arguments = (*shape, pitch, wavelength, distance, params)
        self._cores: Dict[torch.dtype, Any] = {}

    def _core(self, dtype: torch.dtype) -> Any:
        if dtype not in self._cores:
            kinds = {torch.complex64: _core.Propagation32, torch.complex128: _core.Propagation64}
            if dtype not in kinds:
                raise _core.Error(f"expected a complex64 or complex128 tensor, got {dtype}")
            self._cores[dtype] = kinds[dtype](*self._arguments)
        return self._cores[dtype]

    def __call__(self, u: torch.Tensor) -> torch.Tensor:
        result: torch.Tensor = _Apply.apply(u, self._core(u.dtype), False)
        return result

    def adjoint(self, u: torch.Tensor) -> torch.Tensor:
        """The adjoint: the conjugate transfer function, from the output's window to the input's."""
        result: torch.Tensor = _Apply.apply(u, self._core(u.dtype), True)
        return result


def propagate(
    u: torch.Tensor, distance: Length, *, pitch: Length, wavelength: Length, **params: Any
) -> torch.Tensor:
    """A field of samples (..., ny, nx) after free space over ``distance``. For many calls, make a ``Propagation``."""
    if u.ndim < 2:
        raise _core.Error(f"expected a tensor of the shape (..., rows, columns), got {tuple(u.shape)}")
    return Propagation((u.shape[-2], u.shape[-1]), pitch, wavelength, distance, **params)(u)


class _Leave(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, level: torch.Tensor, core: Any) -> torch.Tensor:
        ctx.core = core
        ctx.save_for_backward(level)
        return _each(core.leave, level, torch.float32)

    @staticmethod
    def backward(ctx: Any, *gradients: torch.Tensor) -> Any:
        (level,) = ctx.saved_tensors
        slope = _each(ctx.core.pull_back, level, torch.float32, gradients[0])
        return slope.to(level.dtype), None


class Modulator:
    """A panel: a callable of levels (..., ny, nx), not rounded, to the field that leaves it, as ``ht.show``.

    Between whole levels the calibration is linear. ``params`` are those of ``ht.show``: subpixels, effects, irradiance,
    light, tilts.
    """

    def __init__(self, slm: Panel, wavelength: Length, **params: Any) -> None:
        self.slm: Slm = panel(slm)
        self._core = _core.Panel(self.slm._core, wavelength, params)

    def __call__(self, level: torch.Tensor) -> torch.Tensor:
        result: torch.Tensor = _Leave.apply(level, self._core)
        return result

    def of_phase(self, phase: torch.Tensor) -> torch.Tensor:
        """The field for phases in radians at the design wavelength, of a panel whose levels are even steps of a turn."""
        levels = self.slm.levels
        return self(torch.remainder(phase * (levels / (2 * np.pi)), levels))


def slm(level: torch.Tensor, slm: Panel, *, wavelength: Length, **params: Any) -> torch.Tensor:
    """The field that leaves a panel that is driven with levels. For many calls, make a ``Modulator``."""
    return Modulator(slm, wavelength, **params)(level)


def round_levels(level: torch.Tensor) -> torch.Tensor:
    """Whole levels; the gradient passes as if they were not rounded (the straight-through estimator)."""
    return level + (torch.round(level) - level).detach()


class Camera:
    """The irradiance that a lensless sensor, or an eye, sees of the light that leaves a panel: a callable.

    Parameters
    ----------
    shape, pitch, wavelength
        Samples of the field.
    distance : length
        From the panel to the plane in focus.
    image : "virtual" or "real"
        Plane behind the panel, or in front of it.
    pupil : length
        Diameter of an eye's pupil at ``eye``; 0: all light is used.
    eye : three lengths
    binning : whole number
        Samples of the field per sensor pixel and axis. A pixel reads the mean of its samples, as ``sampling="point"``
        of ``ht.expose``.
    """

    def __init__(
        self,
        shape: Tuple[int, int],
        pitch: Length,
        wavelength: Length,
        distance: Length,
        *,
        image: str = "virtual",
        pupil: Length = 0.0,
        eye: Lengths = (0.0, 0.0, 0.0),
        binning: int = 1,
    ) -> None:
        steps, mask = camera_path(shape, pitch, distance, image, pupil, eye)
        self._steps = [Propagation(pitch=pitch, wavelength=wavelength, **step) for step in steps]
        self._mask: Optional[torch.Tensor] = None if mask is None else torch.from_numpy(mask)
        self._binning = binning

    def __call__(self, u: torch.Tensor) -> torch.Tensor:
        field = self._steps[0](u)
        if self._mask is not None:
            field = self._steps[1](field * self._mask.to(field.device))
        irradiance = field.real**2 + field.imag**2
        n = self._binning
        if n == 1:
            return irradiance
        rows, columns = irradiance.shape[-2] // n, irradiance.shape[-1] // n
        cut = irradiance[..., : rows * n, : columns * n]
        return cut.reshape(cut.shape[:-2] + (rows, n, columns, n)).mean(dim=(-3, -1))


def camera(
    u: torch.Tensor, distance: Length, *, pitch: Length, wavelength: Length, **params: Any
) -> torch.Tensor:
    """What a camera sees of a field of samples (..., ny, nx). For many calls, make a ``Camera``."""
    return Camera((u.shape[-2], u.shape[-1]), pitch, wavelength, distance, **params)(u)
