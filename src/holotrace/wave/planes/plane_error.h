#pragma once

#include <vector>

#include "holotrace/wave/planes/plane_slabs.h"
#include "holotrace/wave/tiles/tile_error.h"

namespace holotrace {

/// The error of the expansion of waves in the tiles of a plan (sum_planes.h), apart from gridding: measured on pixels that the waves
/// light, as measure_split does.
SplitEnergies measure_planes(const std::vector<DrawnPixel>& pixels, const DepthRange& depths, const Grid& grid,
                             const PixelBox& bounds, double wavelength, const PlanesPlan& plan);

}  // namespace holotrace
