#pragma once

#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/grid.h"
#include "holotrace/wave/tiles/tile_error.h"
#include "holotrace/wave/triangles/triangle_part.h"

// A part of a triangle inside a tile of the panel. The wave of its centroid is split into a column times a row, as in
// sum_tiled. Its envelope is a polynomial of degree 3 in the column and in the row, interpolated at Chebyshev nodes.
// Row l of the polynomial is a wave of its own: column factor × Σₖ Cₗₖ·Tₖ, times row factor × Tₗ. A part adds one to
// four terms to the matrix product, fewer where the envelope is smooth or faint.

namespace holotrace {

inline constexpr int envelope_nodes = 4;  ///< interpolation nodes per axis
/// cos((2n + 1)π/8): the zeros of T₄.
inline constexpr double envelope_node[envelope_nodes] = {0.92387953251128674, 0.38268343236508977, -0.38268343236508977,
                                                         -0.92387953251128674};

/// Largest allowed change of the phase between two corners from the centre of a tile to its edges [rad].
inline constexpr double most_phase_change = 2.6;

/// A part seen from a tile, corners ordered by order_corners: phases with their slopes, amplitudes, bulges.
struct PartInTile {
  double phase[3], slope_x[3], slope_y[3];  ///< at the tile's centre [rad]; slopes [rad/m]
  double amplitude[3];
  Phasor<double> bulge[3];  ///< curvature terms of sides 01, 12, 02, in that order
  double gap, gap_change;   ///< [rad]: phase of last less first corner at the centre; change to the tile's edges
};

/// @param x, y            centre of the tile [m]
/// @param half_x, half_y  half the sides of the tile [m]
PartInTile part_in_tile(const TrianglePart& part, double x, double y, double half_x, double half_y, double wavelength);

/// How the moments are found at all nodes of a tile: by quotients if the gap stays above 0.8 rad, else by a series.
enum class MomentMethod { short_series, quotients, long_series };
inline MomentMethod moment_method(const PartInTile& part) {
  if (part.gap + part.gap_change <= 3.2) return MomentMethod::short_series;
  if (part.gap - part.gap_change >= 0.8) return MomentMethod::quotients;
  return MomentMethod::long_series;
}

/// Chebyshev coefficients [row][column] of the envelope in a tile, in double; used to measure errors.
using EnvelopeCoefficients = std::complex<double>[envelope_nodes][envelope_nodes];
void expand_envelope(const PartInTile& part, double half_x, double half_y, EnvelopeCoefficients& c);

/// Sums the parts whose boxes meet `box` into the samples there, in single precision. This is the hot loop of
/// sum_triangles, compiled for every instruction set and chosen at run time. Rows of an envelope are left out if the
/// root of the sum of their squared coefficients, over r, is at most `faint` [√(W/m²)].
void sum_triangle_tile(const std::vector<TrianglePart>& parts, const LitGrid& panel, TileShape tile,
                       const PixelBox& box, double faint, Array2D<std::complex<float>>& samples);

}  // namespace holotrace
