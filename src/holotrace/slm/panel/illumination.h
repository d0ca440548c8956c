#pragma once

#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/source_part.h"

namespace holotrace {

/// The light and the panel at one instant, in which all light interferes. Light of different states does not interfere:
/// a camera sees the sum of the states' irradiances, each times its weight.
struct IlluminationState {
  double wavelength = 0;          ///< [m]
  double tilt_x = 0, tilt_y = 0;  ///< tilt of the light from the panel's axis [rad]
  double flicker = 0;             ///< instantaneous value of the phase ripple, in [−1, 1]
  double weight = 1;              ///< weight of its irradiance; those of one polarisation sum to 1
  SourcePart source{};            ///< the part of an extended source that this direction stands for
  int polarisation = 0;           ///< component of the polarisation (crystal.h): 0 is the one with the most modulation
};

/// The illumination states whose irradiances are averaged for a partly coherent source or a panel that flickers. They
/// are `params.illumination_states` points of a low-discrepancy sequence over the spectrum (a Gaussian), the source (a
/// disc) and the period of the ripple (a sinusoid). They have equal weights, and the mean wavelength and tilt of the
/// source. Each stands for the part of the source nearest to its direction. Coherent light without flicker: one state.
/// Polarisations that leave the panel and do not interfere (CrystalResponse::components) are states of their own, of the
/// same weight each; those of one instant follow each other.
/// The number needed depends on where the light goes: see plan_illumination (run/illumination_plan.h); 0 means 16.
///
/// @param slm         the panel with the effects that are on (with_effects)
/// @param params      bandwidth, source angle, tilt, illumination states
/// @param wavelength  middle of the spectrum [m]
/// @throws Error      for widths or counts below 0, and for a spectrum that reaches 0 m
std::vector<IlluminationState> illumination_states(const Slm& slm, const ShowParams& params, double wavelength);

/// The light on a panel, of amplitude 1 at its centre, on the samples of `grid`:
///
///     plane      exp(2πi(x·sin αx + y·sin αy)/λ)
///     gaussian   that times exp(−(x² + y²)/w²), w the beam radius
///     spherical  (|d|/r)·exp(±ik(r − |d|)), r the distance to the point at −d·(sin αx, sin αy, cos α): + for light
///                that comes from there (d > 0), − for light that goes there (d < 0)
///
/// The first two are a function of the column times a function of the row.
struct Illumination {
  AlignedVector<std::complex<float>> along_x, along_y;  ///< factors of plane and Gaussian light; empty: 1
  Array2D<std::complex<float>> samples;                 ///< for spherical light, otherwise empty

  bool is_even() const { return along_x.empty() && samples.size() == 0; }
};

/// Checks light before the work on it.
/// @param grid    samples of the light on the panel
/// @param state   its wavelength and tilt are used
/// @throws Error  for tilts of 90° and more; for a source distance or beam radius that is needed but 0 or not finite;
///                for light too steep for the samples of the grid, giving the steepest that they can represent
void check_illumination(const Grid& grid, const ShowParams& params, const IlluminationState& state);

/// @throws Error  as check_illumination does
Illumination illuminate(const Grid& grid, const ShowParams& params, const IlluminationState& state);

/// The mean of |light|² over the grid: its power relative to plane light.
double mean_irradiance(const Illumination& light);

}  // namespace holotrace
