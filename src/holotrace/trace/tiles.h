#pragma once

#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/trace.h"

namespace holotrace {

/// A tile of the panel. `centre` is the place from which visibility and radiance are evaluated [m].
struct PanelTile {
  PixelBox box;
  Vec3 centre;
};

/// The tiles of the panel, each of which sees a source from its own place: params.tile_columns × tile_rows, row by row
/// from the top. Only the strategy tiled has tiles; the list is empty for the others.
/// @throws Error  for fewer than 1 × 1 tiles, or more columns or rows than the panel has pixels
inline std::vector<PanelTile> make_tiles(const TraceParams& params, const Grid& panel) {
  if (params.strategy != Strategy::tiled) return {};
  const int columns = params.tile_columns, rows = params.tile_rows;
  require(columns >= 1 && rows >= 1 && columns <= panel.nx && rows <= panel.ny,
          "expected 1 to {} tile_columns and 1 to {} tile_rows on a panel of that many pixels, got {} and {}", panel.nx,
          panel.ny, columns, rows);
  std::vector<PanelTile> tiles;
  for (int t = 0; t < columns * rows; ++t) {
    const PixelBox box = tile_box(panel, columns, rows, t);
    tiles.push_back({box, centre_of(panel, box)});
  }
  return tiles;
}

}  // namespace holotrace
