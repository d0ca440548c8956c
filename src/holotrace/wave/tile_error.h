#pragma once

#include <array>
#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/wave/spherical_wave_kernel.h"

namespace holotrace {

/// Pixels of a tile of the tile-separable sum.
struct TileShape {
  int columns, rows;
  bool operator==(const TileShape&) const = default;
};

/// The shapes that sum_tiled knows, from fast to accurate. The neglected phase goes with
/// columns·rows, and 32 columns suit every vector width.
inline constexpr std::array<TileShape, 8> tile_shapes{
    {{128, 128}, {128, 64}, {64, 64}, {64, 32}, {32, 32}, {32, 16}, {32, 8}, {32, 4}}};

/// Single precision in the factors and the sum leaves this relative error however small the tile.
inline constexpr double tiled_rounding_error = 5e-6;

/// Relative L2 error of splitting r into r₀ + Δr(column) + Δr(row) inside tiles of that shape.
///
/// The split neglects about k·x₀·y₀·u·v/r₀³ for a pixel at (u, v) from the tile's centre, which
/// lies at (x₀, y₀) from the source. The error is measured: at a few thousand pixels, drawn evenly
/// over the waves and their boxes from a fixed seed, the split is compared with the wave itself.
double separability_error(const std::vector<PreparedWave>& waves, const Grid& grid, double wavelength, TileShape tile);

/// A tile and the relative L2 error that is expected of it.
struct TileChoice {
  TileShape tile;
  double error;
  bool meets_tolerance;
};

/// The fastest tile whose expected error, with a margin of a quarter, is below the tolerance; the most
/// accurate one if none is.
TileChoice choose_tile(const std::vector<PreparedWave>& waves, const Grid& grid, double wavelength, double tolerance);

}  // namespace holotrace
