#pragma once

#include <vector>

#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/source_part.h"

namespace holotrace {

/// The light and the panel at one instant, in which all light interferes. Light of different states does not: what a
/// camera sees is the sum of the states' irradiances, each times its weight.
struct IlluminationState {
  double wavelength = 0;          ///< [m]
  double tilt_x = 0, tilt_y = 0;  ///< of the light from the panel's axis [rad]
  double flicker = 0;             ///< where the ripple of the phase stands, in [−1, 1]
  double weight = 1;              ///< of its irradiance; the weights of all states sum to 1
  SourcePart source{};            ///< the part of an extended source that this direction stands for
};

/// The illumination states that a partly coherent source, or a panel that flickers, is averaged over: `params.illumination_states`
/// points of a low-discrepancy sequence over the spectrum (a Gaussian), the source (a disc) and the period of the ripple (a
/// sinusoid), of equal weight, whose wavelengths and tilts have the spectrum's and the source's own means. Each stands
/// for the part of the source that is nearest to its direction. One state where light is coherent and flicker off.
/// How many are needed depends on where the light goes: plan_illumination (run/illumination_plan.h) tells; 0 takes 16.
///
/// @param slm         the panel with the effects that are on (with_effects)
/// @param params      bandwidth, source angle, tilt, illumination states
/// @param wavelength  at the middle of the spectrum [m]
/// @throws Error      for widths or counts below 0, and a spectrum that reaches 0 m
std::vector<IlluminationState> illumination_states(const Slm& slm, const ShowParams& params, double wavelength);

}  // namespace holotrace
