#pragma once

#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"

namespace holotrace {

/// Levels that bring the targets' moduli out of a panel, by descent on
///
///     f(ℓ) = Σ_λ Σₖ Σ wₖ(s_λ·|Tₖu(ℓ)| − aₖ)²/P_λ,   s_λ = Σ w·a·|v| / Σ w·|v|², the best scale for that wavelength
///
/// P_λ being the light Σₖ Σ wₖaₖ² of its targets times the number of wavelengths that have any: each colour counts
/// alike. The light goes through the rounding to levels, the panel (its pixels' aperture, and the effects that
/// params.effects names) and free space. The gradient is analytic: s is at its optimum, so it counts as a constant; g =
/// 2w·s(s|v| − a)·v/|v| goes back by the adjoint of each propagation and of the panel. Rounding is passed straight
/// through: the light is that of whole levels, the gradient moves the drive between them (Bengio, Léonard and
/// Courville, arXiv:1308.3432).
///
/// The step is Adam's (Kingma and Ba, 2015), falling as a half cosine to 0 over the iterations.
///
/// @param targets   of one wavelength or, for one hologram in several colours, of several
/// @param slm       with the effects that are on
/// @param hologram  its levels M, modulation and wavelength; its `level` is where descent begins, and what it ends with
/// @throws Error    for iterations or steps below 0
/// Facts: `iterations`, `loss_first`, `loss_last` (f), and those of judge. Curve `convergence`: the loss
/// before each iteration, and of the levels at the end. Cost: two propagations per plane and iteration and, with
/// effects, the panel's model there and back.
void descend(const std::vector<TargetPlane>& targets, const Slm& slm, const EncodeParams& params,
             const Observer& observer, Hologram& hologram);

/// What the levels of a hologram bring about, as far as its panel is known: sets the illumination that shows the
/// targets at their own brightness, at the hologram's wavelength. Facts: `psnr_db`, `target_efficiency` (encode.h).
void judge(const std::vector<TargetPlane>& targets, const Slm& slm, const Observer& observer, Hologram& hologram);

}  // namespace holotrace
