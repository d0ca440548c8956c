#pragma once

#include <optional>
#include <string>
#include <vector>

#include "holotrace/data/hologram.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/run/viewing.h"
#include "holotrace/slm/panel/illumination_states.h"

namespace holotrace {

/// The illumination states that the light and the panel are averaged over for some views, and why as many.
struct IlluminationPlan {
  std::vector<IlluminationState> states;
  int needed = 1;   ///< for an even blur of the finest point that the views resolve
  std::string why;  ///< empty for coherent light
};

/// The states of partly coherent light (slm/panel/illumination_states.h): params.illumination_states, or where that is 0
/// as many as the views need.
///
/// A source of full angle α blurs the plane at z over a disc of diameter α·z: a convolution of the irradiance
/// (view/source_image.h), done in one state where all the light goes on alike. What bounds it on its way does not move
/// with it: of a pupil D at z_e a part of the source may move the light by D/8, of a pass band of the full angle β
/// (the encoder's stop, or the orders that the samples hold) by β/8,
///
///     N = π/4·max((8α·z_e/D)², (8α/β)²)
///
/// A spectrum of the full width Δλ moves light of the frequency f by f·z·Δλ in the plane at z; the steepest that gets
/// there has f = min(n/2p, S/λz), for n samples per pixel p on a panel of side S. Steps of half the resolution r, which
/// is the largest of the sensor's pixel, λz/S and λ|z − z_e|/D, blend:
///
///     N = 2·f·z·Δλ/r   (8 at least, for what the panel itself does at other wavelengths)
///
/// Flicker takes 16. All together the largest, and 256 at most, beyond which a warning says what is left out.
///
/// @param filter  the encoder's stop, where it is known
/// @throws Error  as illumination_states does
IlluminationPlan plan_illumination(const Slm& slm, const ShowParams& params, double wavelength, ImageSide image,
                                   const std::vector<Viewpoint>& from,
                                   const std::optional<SpectralFilter>& filter = {});

/// The part of the source that moves light the furthest from its own place, for the memory that blurring by it takes
/// (looking_bytes): the first or the last, which without a spectrum are the innermost and the outermost.
SourcePart widest_part(const IlluminationPlan& plan);

/// The warning of a plan whose states, asked for or limited, are too few; empty where they are enough.
std::string doubt_of(const IlluminationPlan& plan, const ShowParams& params);

}  // namespace holotrace
