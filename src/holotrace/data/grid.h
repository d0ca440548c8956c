#pragma once

#include <algorithm>
#include <cstdint>

#include "holotrace/base/vec.h"

namespace holotrace {

/// A panel or a sensor: nx × ny square pixels of side `pitch` [m], centred on the z axis unless told otherwise.
///
///     x(i) = centre_x + (i − (nx−1)/2)·pitch,   y(j) = centre_y + ((ny−1)/2 − j)·pitch
///
/// x points right, y up, row 0 is the top row.
struct Grid {
  int nx = 0, ny = 0;
  double pitch = 0;
  double centre_x = 0, centre_y = 0;  ///< centre of the grid [m]

  double x(double column) const { return centre_x + (column - (nx - 1) / 2.0) * pitch; }
  double y(double row) const { return centre_y + ((ny - 1) / 2.0 - row) * pitch; }
  double width() const { return nx * pitch; }
  double height() const { return ny * pitch; }
  int64_t pixels() const { return int64_t(nx) * ny; }
  bool operator==(const Grid&) const = default;
};

constexpr double largest_pitch = 0.1;        ///< [m]; larger ones are numbers without their unit
constexpr double longest_wavelength = 1e-3;  ///< [m]; far infrared

/// @throws Error unless the grid has pixels and a pitch above 0 m, up to largest_pitch.
void check_grid(const Grid& grid);

/// @throws Error, stating the memory needed, unless a field with that many bytes per sample fits in this machine.
void check_field_fits(const Grid& grid, double bytes_per_sample);

/// @throws Error unless the wavelength [m] is above 0 m, up to longest_wavelength.
void check_wavelength(double wavelength);

/// The same for light on pixels, also unless it is at most 50 times their pitch: no panel and no sampling is that fine.
void check_wavelength(double wavelength, const Grid& grid);

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
