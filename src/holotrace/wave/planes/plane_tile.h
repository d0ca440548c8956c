#pragma once

#include "holotrace/wave/planes/plane_spread.h"

namespace holotrace {

/// Waves in the order that sum_planes takes them: by slab, and within a slab neighbours after each other.
struct SortedWaves {
  std::vector<PreparedWave> waves;
  std::vector<Slab> slabs;
};

/// What all tiles of a panel share.
struct PlanesSum {
  const SortedWaves& waves;
  const PlanesTables& tables;
  const TilePlan& direct;  ///< how the few waves that light a corner of the tile only are summed (tile_sum.h)
  const Grid& grid;
};

/// Adds the waves to the samples of the tile `box` of the panel.
void sum_planes_tile(const PlanesSum& sum, const PixelBox& box, PlanesWorkspace& workspace,
                     Array2D<std::complex<float>>& samples);

}  // namespace holotrace
