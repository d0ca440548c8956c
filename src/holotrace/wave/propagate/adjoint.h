#pragma once

#include <functional>

#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// The adjoint Tᴴ of a propagation T, ⟨Tᴴg, u⟩ = ⟨g, Tu⟩ to rounding: the conjugate transfer function, from the
/// output's window to the input's. It propagates over −distance, with the windows and the band limit of the forward
/// propagation.
///
/// If no light leaves the windows or the band, T keeps the norm and the adjoint is its inverse. In general the norm
/// does not grow, ‖T‖ ≤ 1, if |H| ≤ 1: exactly so for an angular spectrum, nearly for a Rayleigh–Sommerfeld kernel.
///
/// @throws Error  unless both windows lie on one lattice (Propagator::is_on_lattice)
template <class Real>
Propagator<Real> adjoint_of(const Propagator<Real>& propagator);

/// Multiplies the transfer function of a propagator on a lattice by one even real function of frequency per axis. The
/// frequency is in cycles per input sample, |f| ≤ 1/2. Use: filters such as the aperture of a pixel.
template <class Real>
void filter_transfer(Propagator<Real>& propagator, const std::function<double(double)>& along_x,
                     const std::function<double(double)>& along_y);

/// The largest |H| of a propagator: an upper bound of its norm.
template <class Real>
double largest_transfer(const Propagator<Real>& propagator);

}  // namespace holotrace
