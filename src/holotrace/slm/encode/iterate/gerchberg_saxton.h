#pragma once

#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"

namespace holotrace {

/// A phase pattern whose light has the targets' moduli, by projections back and forth through real free space
/// (Gerchberg and Saxton, Optik 35, 237, 1972), for any number of planes at once:
///
///     vₖ = Tₖu,   rₖ = wₖ·(s·aₖ − |vₖ|)·vₖ/|vₖ|,   u ← (u + 1/K·Σₖ Tₖᴴrₖ)/|…|
///
/// Tₖ is the propagation to plane k with its window, zero-padding and the pixels' aperture, s the scale that fits the
/// start. Where w is 0 the light stays as it is: noise may go there. For one plane and a unitary T, where w is 1
/// everywhere, Tᴴv = u and this is the classical algorithm: replace the modulus, go back, keep the phase.
///
/// **The error never grows.** E(u) = 1/K·Σₖ Σ wₖ(|vₖ| − s·aₖ)². For ‖Tₖ‖ ≤ 1 and wₖ ≤ 1, with gₖ = vₖ + rₖ/wₖ,
///
///     E(u') ≤ 1/K·Σₖ ‖√wₖ(Tₖu' − gₖ)‖² ≤ E(u) − 2Re⟨u' − u, 1/K·ΣTₖᴴrₖ⟩ + ‖u' − u‖² =: Q(u'),   Q(u) = E(u)
///
/// and among patterns of modulus 1 the step above is the one that makes Q least. Nothing else is asked of T: it holds
/// with light that leaves the window, with a band limit, and with a don't-care region. It does not hold for the
/// weighted way, nor, by its last digits, for the rounding of floats.
///
/// Weighted: in each iteration aₖ is multiplied by 1 + (s·aₖ⁰/|vₖ| − 1)/10, the bracket within ±1 and aₖ at most 2aₖ⁰,
/// s fitted anew: pixels that fall short ask for more (after Di Leonardo, Ianni and Ruocco, Opt. Express 15, 1913,
/// 2007). Made for spots, which it evens out; of pictures the plain way is nearer.
///
/// @param targets  of one wavelength
/// @param start    pattern of modulus 1, shape (ny, nx)
/// @return         the pattern after iterations_of(params), not yet of levels
/// @throws Error   for targets of several wavelengths, and iterations below 0
/// Curve `convergence`: E/(s²·1/K·Σ w·a²) before each iteration and after the last.
/// Cost: two propagations per plane and iteration.
Array2D<std::complex<float>> project_in_turn(std::vector<TargetPlane> targets, Array2D<std::complex<float>> start,
                                             const Slm& slm, const EncodeParams& params, const Observer& observer);

}  // namespace holotrace
