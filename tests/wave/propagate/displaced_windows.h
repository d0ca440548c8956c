#pragma once

#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/propagate.h"

namespace holotrace {

/// Displacements right and down, in samples.
inline const std::vector<Vec2> shifts{{0, 0}, {-0.25, -0.25}, {0.25, 0}, {0, 0.4}, {-1.3, 0.7}};

/// A propagation to that grid.
inline PropagateParams window(const Grid& grid) {
  return {
      .columns = grid.nx, .rows = grid.ny, .pitch = grid.pitch, .centre_x = grid.centre_x, .centre_y = grid.centre_y};
}

}  // namespace holotrace
