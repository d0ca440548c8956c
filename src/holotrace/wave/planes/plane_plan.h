#pragma once

#include <vector>

#include "holotrace/wave/planes/plane_slabs.h"
#include "holotrace/wave/tiles/tile_error.h"

namespace holotrace {

/// A plan, the relative L2 error expected of it and the work that it needs.
struct PlanesChoice {
  PlanesPlan plan;
  double error = 0;
  SummationWork work;
  double seconds = 0;  ///< predicted for one thread
  SplitEnergies energies;
  bool meets_tolerance = false;
};

/// Whether a wave suits `planes`: its box must be at least four of the smallest tiles wide, so that fewer than half of
/// its tiles are partly lit. The panel's acceptance must be below 14 degrees (pixels of two wavelengths): beyond it
/// the expansion in sum_planes.h is not valid in tiles of that size.
bool suits_planes(const PreparedWave& wave, double wavelength, double pitch);

/// The fastest plan on this machine (cost_model.h) whose expected error, with a margin of 25 %, is below the
/// tolerance; the most accurate one if none is.
/// @param waves      waves that suit the method (suits_planes), at least one
/// @param direct     plan for the direct sum in tiles that contain a corner of a wave's box
/// @param most_seconds  plans that take one thread longer than this are skipped [s]
PlanesChoice choose_planes(const std::vector<PreparedWave>& waves, const TilePlan& direct, const SumGoal& goal,
                           double most_seconds = 1e300);

}  // namespace holotrace
