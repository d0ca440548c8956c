#pragma once

#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"

namespace holotrace {

class Device;

/// A pattern, shape (ny, nx), and the device that has found it; none: the processor.
struct ProjectedPattern {
  Array2D<std::complex<float>> pattern;
  Device* device;
};

/// A phase pattern whose light has the targets' moduli, found by projections to the planes and back through free space
/// (Gerchberg and Saxton, Optik 35, 237, 1972), for any number of planes at once:
///
///     vₖ = Tₖu,   rₖ = wₖ·(s·aₖ − |vₖ|)·vₖ/|vₖ|,   u ← m·(u + 1/K·Σₖ Tₖᴴrₖ)/|…|
///
/// m is the amplitude of the light on the panel, √ of its light map if that is among the effects of `slm`, else 1.
/// Tₖ is the propagation to plane k with its window, zero-padding and the pixels' aperture; s is the scale that fits
/// the start. Where w is 0, the light stays as it is, so noise may go there. For one plane and a unitary T, with w = 1
/// everywhere, Tᴴv = u and this is the classical algorithm: replace the modulus, propagate back, keep the phase.
///
/// **The error never grows.** E(u) = 1/K·Σₖ Σ wₖ(|vₖ| − s·aₖ)². For ‖Tₖ‖ ≤ 1 and wₖ ≤ 1, with gₖ = vₖ + rₖ/wₖ,
///
///     E(u') ≤ 1/K·Σₖ ‖√wₖ(Tₖu' − gₖ)‖² ≤ E(u) − 2Re⟨u' − u, 1/K·ΣTₖᴴrₖ⟩ + ‖u' − u‖² =: Q(u'),   Q(u) = E(u)
///
/// Among patterns of modulus m, the step above minimizes Q. Nothing else is required of T: the statement holds for
/// light that leaves the window, for a band limit, and for a region of weight 0. It does not hold for the weighted
/// method, nor exactly in single precision, where rounding changes the last digits.
///
/// Weighted: in each iteration aₖ is multiplied by 1 + (s·aₖ⁰/|vₖ| − 1)/10, with the bracket limited to ±1 and aₖ to
/// 2aₖ⁰, and s is fitted again. Pixels that are too dark thus get a larger target (after Di Leonardo, Ianni and Ruocco,
/// Opt. Express 15, 1913, 2007). It evens out spots, for which it was made; for pictures the plain method is better.
///
/// **On a device** (params.device), the pattern, its light in all planes and the propagations are in its memory, in single
/// precision. The sums of the rows of each plane come back, one float per row (weighted: three), and the pattern at the
/// end. If the light of all planes does not fit there, that of one plane after the other does (DeviceProjection), with the same result. If the device `auto` fails, the processor starts again, with a warning.
///
/// @param targets  target planes of one wavelength
/// @param start    pattern of modulus 1, shape (ny, nx)
/// @param slm      panel with the effects that are known (known_panel)
/// @return         the pattern after iterations_of(params), not yet rounded to levels
/// @throws Error   for targets of several wavelengths, and iterations below 0; as device_for_projections and Device do
/// Facts: `iterations`, `device` (its name, on a device), `error_first`, `error_last`. Curve `convergence`:
/// E/(s²·1/K·Σ w·a²) before each iteration and after the last. Cost: two propagations per plane and iteration.
ProjectedPattern project_in_turn(const std::vector<TargetPlane>& targets, const Array2D<std::complex<float>>& start,
                                 const Slm& slm, const EncodeParams& params, const Observer& observer);

}  // namespace holotrace
