#pragma once

#include <string>
#include <vector>

#include "holotrace/wave/planes/plane_plan.h"
#include "holotrace/wave/summation.h"
#include "holotrace/wave/tiles/tile_error.h"

namespace holotrace {

/// The waves of one part of the panel, split into those for `planes` (far) and for tiles (near), and both plans. The plan
/// for tiles also serves the light of far waves in tiles that they light partly.
struct PartPlan {
  std::vector<PreparedWave> far, near;
  PlanesChoice planes;
  TileChoice tiles;

  bool meets_tolerance() const {
    return (far.empty() || planes.meets_tolerance) && tiles.meets_tolerance;  // `planes` also uses tiles
  }
  double error() const { return std::max(far.empty() ? 0 : planes.error, near.empty() ? 0 : tiles.error); }
  double energy() const { return planes.energies.waves + (near.empty() ? 0 : tiles.energies.waves); }
};

/// The plan of the approach whose expected error is below the tolerance, or the most accurate one if none is. `cheapest` is
/// that with less predicted time where the waves are to be summed. A device that was not measured sums by tiles then.
PartPlan make_part_plan(const std::vector<PreparedWave>& waves, const SumGoal& goal, const SumWay& way);

/// Predicted seconds, with all threads, or on all devices of the way; infinite for devices that were not measured.
double seconds_of(const PartPlan& plan, const PixelBox& bounds, const SumWay& way);

/// How the plan sums, in words.
std::string describe(const PartPlan& plan, const std::vector<Device*>& devices);

}  // namespace holotrace
