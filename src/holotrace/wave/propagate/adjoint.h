#pragma once

#include <functional>

#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// The adjoint Tᴴ of a propagation T, ⟨Tᴴg, u⟩ = ⟨g, Tu⟩ to rounding: the conjugate of the transfer function, from the
/// output's window to the input's. It is propagation over −distance, window and band limit of the way back those of
/// the way there.
///
/// Where no light leaves the windows or the band it is the inverse, too: T then keeps the norm. Else it does not raise
/// it, ‖T‖ ≤ 1, as long as |H| ≤ 1: an angular spectrum is exactly so, a Rayleigh–Sommerfeld kernel nearly.
///
/// @throws Error  unless both windows lie on one lattice (Propagator::is_on_lattice)
template <class Real>
Propagator<Real> adjoint_of(const Propagator<Real>& propagator);

/// Multiplies the transfer function of a propagator on a lattice by even real factors of the frequency along each axis,
/// in cycles per input sample, |f| ≤ 1/2: a filter in the way of the light, such as the aperture of a pixel.
template <class Real>
void filter_transfer(Propagator<Real>& propagator, const std::function<double(double)>& along_x,
                     const std::function<double(double)>& along_y);

/// The largest |H| of a propagator: a bound of its norm.
template <class Real>
double largest_transfer(const Propagator<Real>& propagator);

}  // namespace holotrace
