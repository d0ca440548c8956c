#pragma once

#include <array>
#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/data/summation_rates.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"
#include "holotrace/wave/shared/wave_draw.h"

namespace holotrace {

/// Where waves are summed: the panel's pixels, in their light.
struct LitGrid {
  const Grid& grid;
  double wavelength;  ///< [m]
};

/// Pixels of a tile of the tile-separable sum.
struct TileShape {
  int columns, rows;
  bool operator==(const TileShape&) const = default;
};

/// The precision of the products in a tile: single; bf16 in two parts each, of which three products are taken; bf16.
enum class TileProducts { single, split_bf16, bf16 };

/// How a tile is summed.
struct TilePlan {
  TileShape shape;
  TileProducts products = TileProducts::single;
  bool operator==(const TilePlan&) const = default;
};

/// The shapes that sum_tiled knows, from fast to accurate. The neglected phase goes with columns·rows. 32 columns suit
/// every vector width, 6 rows the block of the product, and most divide 1080p and 4K panels.
inline constexpr std::array<TileShape, 10> tile_shapes{
    {{128, 120}, {128, 60}, {64, 60}, {64, 30}, {32, 30}, {32, 18}, {32, 12}, {32, 6}, {32, 4}, {32, 2}}};

/// Relative error that the products leave however small the tile; it is independent of the split's.
double rounding_error(TileProducts products);

/// What splitting r into r₀ + Δr(column) + Δr(row) inside tiles does to a set of waves: the energies
/// of the error and of the waves, Σⱼ Σ over the pixels of j of |error|² and |Uⱼ|² [W/m²].
struct SplitEnergies {
  double error = 0, waves = 0;
};

/// Where waves are summed, and how well.
struct SumGoal {
  Grid grid;
  PixelBox bounds;        ///< pixels that are summed; tiles cover them from the top left corner on
  double wavelength = 0;  ///< [m]
  double tolerance = 0;   ///< relative L2 error
  double coherence = 1;   ///< energy of the field over the sum of its waves' energies: 1 for random phases, less
                          ///< where the waves cancel, so that their errors weigh more
};

/// The split neglects about k·x₀·y₀·u·v/r₀³ for a pixel at (u, v) from the tile's centre, which lies at
/// (x₀, y₀) from the source. Its error is measured: at pixels that the waves light (draw_pixels), the split is compared
/// with the wave itself.
///
/// @param bounds  the pixels that the tiles cover, from its top left corner on
SplitEnergies measure_split(const std::vector<DrawnPixel>& pixels, const Grid& grid, const PixelBox& bounds,
                            double wavelength, TileShape tile);

/// A way to sum tiles, and the relative L2 error that is expected of it: that of the split, √(error/waves), and the
/// rounding, over √coherence.
struct TileChoice {
  TilePlan plan;
  double error = 0;
  SplitEnergies energies;
  bool meets_tolerance = false;
};

/// The fastest plan on this machine (cost_model.h) whose expected error, with a margin of a quarter, is below the
/// tolerance; the most accurate one if none is.
TileChoice choose_tile(const std::vector<DrawnPixel>& pixels, const SumGoal& goal);

/// Work of a plan for one wave and pixel: its products and, spread over the tile, what is done once per column and row
/// and once per tile.
SummationWork tile_work(const TilePlan& plan);

/// The same for tiles over the whole grid.
inline TileChoice choose_tile(const std::vector<PreparedWave>& waves, const Grid& grid, double wavelength,
                              double tolerance, double coherence = 1) {
  return choose_tile(draw_pixels(waves), {grid, {0, grid.nx, 0, grid.ny}, wavelength, tolerance, coherence});
}

}  // namespace holotrace
