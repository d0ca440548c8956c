#pragma once

#include <vector>

#include "holotrace/wave/planes/plane_slabs.h"
#include "holotrace/wave/tiles/tile_error.h"

namespace holotrace {

/// A plan, the relative L2 error expected of it and the work it makes.
struct PlanesChoice {
  PlanesPlan plan;
  double error = 0;
  SummationWork work;
  double seconds = 0;  ///< that one thread should take for it
  SplitEnergies energies;
  bool meets_tolerance = false;
};

/// Whether a wave's box is at least four of the smallest tiles wide: fewer than half of its tiles are lit in part.
/// And whether the panel's acceptance is below 14 degrees, as for pixels of two wavelengths: at wider angles
/// the expansion in sum_planes.h does not hold in tiles of that size.
bool suits_planes(const PreparedWave& wave, double wavelength, double pitch);

/// The fastest plan on this machine (cost_model.h) whose expected error, with a margin of a quarter, is below the
/// tolerance; the most accurate one if none is.
/// @param waves      all of which suit the method (suits_planes), at least one
/// @param direct     how waves are summed in the tiles that hold a corner of their box
/// @param most_seconds  plans that take one thread longer are not looked at
PlanesChoice choose_planes(const std::vector<PreparedWave>& waves, const TilePlan& direct, const SumGoal& goal,
                           double most_seconds = 1e300);

}  // namespace holotrace
