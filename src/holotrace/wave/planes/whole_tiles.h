#pragma once

#include <vector>

#include "holotrace/wave/planes/plane_spread.h"

namespace holotrace {

/// The tiles of a plan, from the top left corner of `bounds` on.
struct PlaneTiles {
  Grid grid;
  PixelBox bounds;
  int side = 0;        ///< [pixels]
  double tangent = 0;  ///< of the panel's acceptance, with a margin (PlanesModel)

  int across() const { return (bounds.x1 - bounds.x0 + side - 1) / side; }
  int down() const { return (bounds.y1 - bounds.y0 + side - 1) / side; }
};

/// The tiles [x0, x1) × [y0, y1) that a wave lights wholly, and whose reference pixels it reaches within the panel's
/// acceptance, so that its frequency is on their grids. They are a rectangle, which may be empty.
PixelBox whole_tiles(const PreparedWave& wave, const PlaneTiles& tiles);

/// Appends the light of `some` waves in all other tiles to `waves`: for each up to four waves, with the boxes that are left
/// around whole_tiles.
void append_rest(const std::vector<PreparedWave>& some, const PlaneTiles& tiles, std::vector<PreparedWave>& waves);

}  // namespace holotrace
