#pragma once

#include <complex>

#include "holotrace/base/array.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/show.h"
#include "holotrace/slm/panel/illumination_states.h"

namespace holotrace {

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
