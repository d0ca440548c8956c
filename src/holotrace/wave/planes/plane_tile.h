#pragma once

#include "holotrace/wave/planes/plane_spread.h"

namespace holotrace {

/// Waves in the order of their use in sum_planes: by slab, and neighbours one after the other within a slab.
struct SortedWaves {
  std::vector<PreparedWave> waves;
  std::vector<Slab> slabs;
};

/// Data shared by all tiles of a panel.
struct PlanesSum {
  const SortedWaves& waves;
  const PlanesTables& tables;
  const TilePlan& direct;  ///< plan for waves that light only a corner of the tile (tile_sum.h)
  const Grid& grid;
};

/// exp(iπκu²)/φ̂ at the tile's pixels along an axis: the curvature κ of a node [cycles/m²], and the correction of the
/// gridding kernel.
std::vector<std::complex<float>> plane_chirp(const PlanesTables& tables, double kappa);

/// Adds the waves to the samples of the tile `box` of the panel.
void sum_planes_tile(const PlanesSum& sum, const PixelBox& box, PlanesWorkspace& workspace,
                     Array2D<std::complex<float>>& samples);

}  // namespace holotrace
