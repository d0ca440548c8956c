#pragma once

#include <vector>

#include "holotrace/wave/planes/plane_slabs.h"
#include "holotrace/wave/tiles/tile_error.h"

namespace holotrace {

/// The error of the expansion of waves in the tiles of a plan (sum_planes.h), without the error of gridding. It is
/// measured at pixels that the waves light, as in measure_split.
SplitEnergies measure_planes(const std::vector<DrawnPixel>& pixels, const WaveDepths& depths, const Grid& grid,
                             const PixelBox& bounds, double wavelength, const PlanesPlan& plan);

/// Relative L2 error of rounding, over all of the panel's acceptance: products in single precision, and frequencies of up to
/// `tile` cells that are floats, too. Measured.
double rounding_error_of_planes(const PlanesPlan& plan);

}  // namespace holotrace
