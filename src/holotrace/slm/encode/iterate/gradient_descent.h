#pragma once

#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"

namespace holotrace {

/// Levels whose light has the targets' moduli, found by gradient descent on
///
///     f(ℓ) = Σ_λ Σₖ Σ wₖ(s_λ·|Tₖu(ℓ)| − aₖ)²/P_λ,   s_λ = Σ w·a·|v| / Σ w·|v|², the best scale for that wavelength
///
/// P_λ is the light Σₖ Σ wₖaₖ² of the wavelength's targets, times the number of wavelengths that have any light: all
/// colours count alike. The light passes the rounding to levels, the panel (its pixels' aperture, and the effects that
/// params.effects names) and free space. The gradient is analytic: s is at its optimum, so it counts as a constant, and
/// g = 2w·s(s|v| − a)·v/|v| goes back by the adjoints of the propagations and of the panel. Rounding is treated as the
/// identity in the gradient: the light is that of whole levels, while the gradient moves the unrounded drive (Bengio,
/// Léonard and Courville, arXiv:1308.3432).
///
/// The step is Adam's (Kingma and Ba, 2015); its size falls to 0 over the iterations as a half cosine.
///
/// @param targets   target planes of one wavelength or, for one hologram in several colours, of several
/// @param slm       panel with the effects that are on
/// @param hologram  its levels M, modulation and wavelength are used; its `level` is the start, and then the result
/// @throws Error    for a number of iterations or a step size below 0
/// Facts: `iterations`, `loss_first`, `loss_last` (f), and those of judge. Curve: `convergence`, the loss
/// before each iteration, and that of the final levels. Cost: two propagations per plane and iteration and, with
/// effects, the panel model forward and back.
void descend(const std::vector<TargetPlane>& targets, const Slm& slm, const EncodeParams& params,
             const Observer& observer, Hologram& hologram);

/// Evaluates the levels of a hologram with the known effects of its panel. Sets the illumination that shows the
/// targets at their own brightness, at the hologram's wavelength. Facts: `psnr_db`, `target_efficiency` (encode.h).
void judge(const std::vector<TargetPlane>& targets, const Slm& slm, const Observer& observer, Hologram& hologram);

}  // namespace holotrace
