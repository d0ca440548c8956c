#pragma once

#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

// Each function fills the transfer function of a propagator whose windows, distance and sampling are set.

/// Samples of the angular-spectrum transfer function.
template <class Real>
void fill_angular_spectrum(Propagator<Real>& propagator);

/// Transform of the sampled Rayleigh–Sommerfeld kernel: the propagation is the direct sum Σ h(p − p′)·u(p′)·pitch².
template <class Real>
void fill_rayleigh_sommerfeld(Propagator<Real>& propagator);

/// Paraxial: the product of one factor per axis. Each is the transfer function exp(−iπλz·u²) where that is sampled
/// well, |z| ≤ 2pS/λ, otherwise the transform of the kernel exp(iπx²/λz)/√(iλz).
template <class Real>
void fill_fresnel(Propagator<Real>& propagator);

}  // namespace holotrace
