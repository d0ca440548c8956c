#pragma once

#include <vector>

#include "holotrace/data/slm.h"

namespace holotrace {

// The light that a panel's levels send through its liquid crystal, polarisers and wave plates (Crystal, jones.h).
//
// Level ℓ delays light along the director by δ_ℓ in all. The crystal is J_ℓ: a twisted cell with the delay δ_ℓ for one pass, and
// with δ_ℓ/2 forward and backward before a mirror. With the light p behind the polariser, plates B before the panel and A behind it,
//
//     e_ℓ = A·J_ℓ·B·p
//
// leaves. What interferes is one **polarisation component** of e_ℓ, a complex number t_ℓ for each level, as a calibration has.
// An analyser a passes one component, t_ℓ = a†·e_ℓ. Without an analyser both components of e_ℓ leave and their irradiances
// add up. They are taken along the polarisation in which the levels differ most and across it. So a parallel-aligned
// crystal has the component along its director, cos θ·exp(iδ_ℓ) for a polariser at the angle θ to it, and sin θ, which no level changes: it
// goes to the zero order. Unpolarised light is an even mixture of two polarisations that do not interfere; each has its own
// components. The first is the one that the crystal modulates most.
//
// Delays are lengths: at the wavelength λ all of them, those of plates too, are λ₀/λ of those at the design wavelength. Dispersion
// of the birefringence is left out. The ripple of flicker multiplies the delays of the crystal alone.

/// The component of light at each of some places on the scale of levels, which rise: phase [rad], continuous, and amplitude. The amplitude is
/// negative beyond a level at which it passes through 0, in place of a phase that jumps by π.
///
/// @param slm        a panel that has a crystal
/// @param places     levels of the panel, 0 or more, also fractions: delays are linear between levels, and continue beyond the last one
/// @param stretch    λ₀/λ
/// @param ripple     relative ripple of the delays, from flicker
/// @param component  0 … 3
std::vector<CalibrationPoint> crystal_response(const Slm& slm, const std::vector<double>& places, double stretch,
                                               double ripple, int component);

/// The components in which light leaves the panel, that with the most modulation first. Without a crystal, or if all is dark: 0 alone.
std::vector<int> polarisation_components(const Slm& slm, double stretch);

}  // namespace holotrace
