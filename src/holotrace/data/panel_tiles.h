#pragma once

#include <algorithm>
#include <cstdint>

#include "holotrace/base/vec.h"
#include "holotrace/data/grid.h"

namespace holotrace {

/// First pixel of tile `index` on an axis of `pixels` pixels cut into `count` tiles: ⌊index·pixels/count⌋.
inline int tile_start(int index, int count, int pixels) { return int(int64_t(index) * pixels / count); }

/// The pixels [x0, x1) × [y0, y1) of a panel.
struct PixelBox {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  bool is_empty() const { return x0 >= x1 || y0 >= y1; }
  int64_t pixels() const { return is_empty() ? 0 : int64_t(x1 - x0) * (y1 - y0); }
};

/// The pixels that both boxes have.
inline PixelBox intersect(const PixelBox& a, const PixelBox& b) {
  return {std::max(a.x0, b.x0), std::min(a.x1, b.x1), std::max(a.y0, b.y0), std::min(a.y1, b.y1)};
}

/// The pixels of tile t = r·columns + c of a panel cut into columns × rows tiles (TileAmplitudes). A tile is empty if
/// there are more tiles than pixels.
inline PixelBox tile_box(const Grid& panel, int columns, int rows, int tile) {
  const int c = tile % columns, r = tile / columns;
  return {tile_start(c, columns, panel.nx), tile_start(c + 1, columns, panel.nx), tile_start(r, rows, panel.ny),
          tile_start(r + 1, rows, panel.ny)};
}

/// The centre of a box of pixels on the panel [m].
inline Vec3 centre_of(const Grid& panel, const PixelBox& box) {
  return {panel.x((box.x0 + box.x1 - 1) / 2.0), panel.y((box.y0 + box.y1 - 1) / 2.0), 0};
}

}  // namespace holotrace
