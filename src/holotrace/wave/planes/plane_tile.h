#pragma once

#include "holotrace/wave/planes/plane_spread.h"
#include "holotrace/wave/tiles/tile_sum.h"

namespace holotrace {

/// Waves in the order that sum_planes takes them: by slab, and within a slab neighbours after each other.
struct SortedWaves {
  std::vector<PreparedWave> waves;
  std::vector<Slab> slabs;
};

/// Adds the waves to the samples of the tile `box` of the panel.
///
/// @param direct  how the few waves that light a corner of the tile only are summed (tile_sum.h)
void sum_planes_tile(const SortedWaves& waves, const PlanesTables& tables, const TilePlan& direct, const Grid& grid,
                     const PixelBox& box, PlanesWorkspace& workspace, TileWorkspace& tile_workspace,
                     Array2D<std::complex<float>>& samples);

}  // namespace holotrace
