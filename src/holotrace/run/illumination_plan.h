#pragma once

#include <optional>
#include <string>
#include <vector>

#include "holotrace/data/hologram.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/run/viewing.h"
#include "holotrace/slm/panel/illumination.h"

namespace holotrace {

/// The number of illumination states over which the light and the panel are averaged for some views, and its reason.
struct IlluminationPlan {
  std::vector<IlluminationState> states;
  int instants = 1;  ///< number of states of one polarisation
  int needed = 1;    ///< number of instants that blurs evenly the finest point that the views resolve
  std::string why;   ///< empty for coherent light
};

/// The states of partly coherent light (slm/panel/illumination.h): params.illumination_states, or for 0
/// as many as the views need.
///
/// A source of full angle α blurs the plane at z over a disc of diameter α·z. This is a convolution of the irradiance
/// (view/source_image.h), which takes one state if nothing limits the light. A pupil or a pass band limits it and does
/// not move with it. A part of the source may then move the light by D/8 for a pupil D at z_e, and by β/8 for a pass
/// band of full angle β (the encoder's stop, or the orders that the samples represent):
///
///     N = π/4·max((8α·z_e/D)², (8α/β)²)
///
/// A spectrum of the full width Δλ moves light of frequency f by f·z·Δλ in the plane at z. The steepest light that
/// arrives there has f = min(n/2p, S/λz), for n samples per pixel p on a panel of side S. The shifted pictures blend if
/// their steps are half the resolution r, the largest of the sensor's pixel, λz/S and λ|z − z_e|/D:
///
///     N = 2·f·z·Δλ/r   (at least 8, because the panel itself differs at other wavelengths)
///
/// Polarisations that a crystal lets leave beside each other take these states each (slm/panel/crystal.h).
///
/// Eyes that the job does not ask for (is_asked_for) need none of their own. Flicker takes 16. The largest of these numbers is used, at most 256; beyond that a warning says what is left out.
///
/// @param filter  the encoder's stop, if it is known
/// @throws Error  as illumination_states does, and as check_illumination does for each of them
IlluminationPlan plan_illumination(const Slm& slm, const ShowParams& params, double wavelength, ImageSide image,
                                   const std::vector<Viewpoint>& from,
                                   const std::optional<SpectralFilter>& filter = {});

/// The part of the source that moves light the farthest; the memory for the blur depends on it
/// (looking_bytes). It is the first or the last part; without a spectrum these are the innermost and the outermost.
SourcePart widest_part(const IlluminationPlan& plan);

/// The warning for a plan with too few states (asked for or limited); empty if they are enough.
std::string doubt_of(const IlluminationPlan& plan, const ShowParams& params);

}  // namespace holotrace
