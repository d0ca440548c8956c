#pragma once

#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/grid.h"
#include "holotrace/wave/tiles/tile_error.h"
#include "holotrace/wave/triangles/triangle_part.h"

// A part of a triangle inside a tile of the panel: the wave of its centroid is split into a column times a row, as in
// sum_tiled, and its envelope is a polynomial of degree 3 in the column and in the row, taken at Chebyshev's points.
// Row l of the polynomial makes a wave of its own, column factor × Σₖ Cₗₖ·Tₖ by row factor × Tₗ: a matrix product of up
// to four terms for each part, fewer where the envelope is smooth or faint.

namespace holotrace {

inline constexpr int envelope_nodes = 4;  ///< per axis
/// cos((2n + 1)π/8): the zeros of T₄.
inline constexpr double envelope_node[envelope_nodes] = {0.92387953251128674, 0.38268343236508977, -0.38268343236508977,
                                                         -0.92387953251128674};

/// Most that the phase between two corners may change from the centre of a tile to its edges [rad].
inline constexpr double most_phase_change = 2.6;

/// A part as a tile sees it, corners ordered by order_corners: phases with their slopes, amplitudes, and bulges.
struct PartInTile {
  double phase[3], slope_x[3], slope_y[3];  ///< [rad], [rad/m]
  double amplitude[3];
  Phasor<double> bulge[3];  ///< of sides 01, 12, 02 in that order
  double gap, gap_change;   ///< between the first and last corner at the centre, and from there to the tile's edges
};

/// @param x, y       centre of the tile [m]
/// @param half_x, y  from there to its edges [m]
PartInTile part_in_tile(const TrianglePart& part, double x, double y, double half_x, double half_y, double wavelength);

/// How the moments are found at all nodes of a tile: by quotients where the gap stays above 0.8 rad.
enum class MomentMethod { short_series, quotients, long_series };
inline MomentMethod moment_method(const PartInTile& part) {
  if (part.gap + part.gap_change <= 3.2) return MomentMethod::short_series;
  if (part.gap - part.gap_change >= 0.8) return MomentMethod::quotients;
  return MomentMethod::long_series;
}

/// Chebyshev coefficients [row][column] of the envelope in a tile, in double: for measuring errors.
using EnvelopeCoefficients = std::complex<double>[envelope_nodes][envelope_nodes];
void expand_envelope(const PartInTile& part, double half_x, double half_y, EnvelopeCoefficients& c);

/// Sums the parts whose boxes meet `box` into the samples there, in single precision: the hot loop of sum_triangles,
/// compiled for every instruction set and chosen at run time. Rows of an envelope whose coefficients are below `faint`,
/// as root of the sum of their squares over r [√(W/m²)], are left out.
void sum_triangle_tile(const std::vector<TrianglePart>& parts, const LitGrid& panel, TileShape tile,
                       const PixelBox& box, double faint, Array2D<std::complex<float>>& samples);

}  // namespace holotrace
