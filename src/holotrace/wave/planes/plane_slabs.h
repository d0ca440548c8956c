#pragma once

#include <vector>

#include "holotrace/wave/planes/plane_tile.h"

namespace holotrace {

/// Depths of a set of waves [m].
struct WaveDepths {
  double nearest, farthest;
};

/// @param waves  at least one wave
WaveDepths depths_of(const std::vector<PreparedWave>& waves);

/// Slabs of equal steps of 1/depth, from the nearest wave to the farthest.
struct Slabs {
  WaveDepths depths;
  int count;

  int of(double depth) const;

  /// The curvatures of slab `index` in the tiles that its waves light; the range of its waves is set later.
  Slab slab(int index, double wavelength, double pitch) const;

 private:
  double step() const { return (1 / depths.nearest - 1 / depths.farthest) / count; }
};

/// Sorts the waves for a plan: by depth into its slabs, and within a slab by position.
SortedWaves sort_waves(std::vector<PreparedWave> waves, const PlanesPlan& plan, double wavelength, double pitch);

}  // namespace holotrace
