#pragma once

#include "holotrace/wave/propagator.h"

namespace holotrace {

// Each fills a propagator whose windows, distance and padded sizes are set: transfer and band.

/// Samples of the angular-spectrum transfer function, zero from the indices band_nx, band_ny on.
template <class Real>
void fill_angular_spectrum(Propagator<Real>& propagator, int band_nx, int band_ny);

/// Transform of the sampled Rayleigh–Sommerfeld kernel: the field becomes the direct sum
/// Σ h(p − p′)·u(p′)·pitch², to rounding.
template <class Real>
void fill_rayleigh_sommerfeld(Propagator<Real>& propagator);

/// Paraxial: the product of one factor per axis, each the transfer function exp(−iπλz·u²) where that is
/// sampled well, |z| ≤ 2pS/λ, and else the transform of the kernel exp(iπx²/λz)/√(iλz).
template <class Real>
void fill_fresnel(Propagator<Real>& propagator);

}  // namespace holotrace
