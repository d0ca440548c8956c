#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/cycles.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/sources.h"
#include "holotrace/wave/tiles/tile_error.h"
#include "holotrace/wave/triangles/triangle_moments.h"

namespace holotrace {

/// A triangle, or a piece of one, prepared for summation. Its field is the spherical wave of its centroid times an
/// envelope, which is the triangle's Fourier transform (envelope_at):
///
///     U(p) = exp(2πi(start + (r − depth)/λ))·(1/r)·E(p),   r = ‖p − centroid‖
struct TrianglePart {
  Vec3 centroid;                  ///< [m]
  double depth;                   ///< −centroid.z [m]
  std::array<Vec3, 3> offsets;    ///< corners from the centroid [m]
  std::array<double, 3> along;    ///< component of each offset along the triangle's direction [m]
  std::array<double, 3> weights;  ///< 2·(area along the direction)/λ·a at the corners [√W]
  double start_cycles;            ///< cycles of the wave at the panel: phase of the centroid plus depth/λ, reduced
  PixelBox box;                   ///< pixels that it lights
};

/// How finely triangles are cut.
struct PartLimits {
  /// Largest phase by which light from the middle of a side may lag behind the mean of its ends [rad].
  double bulge = 0.01;
  /// Largest change over the panel of the phase between the ends of a side [rad/m].
  double slope = std::numeric_limits<double>::infinity();
};

/// Upper limit of the length of a side as seen from anywhere on the panel within the tangent [m].
inline double length_across(Vec3 side, double tangent) {
  const double slope = std::isfinite(tangent) ? std::sqrt(2.0) * tangent : 1;
  return std::min(std::hypot(side.x, side.y) + std::abs(side.z) * slope, length(side));
}

/// Triangles cut into parts, each with the pixels that it lights.
///
/// **What a triangle lights.** Like a wave (Source), it lights only pixels whose fringes the panel can represent: those
/// with
/// |x − xc|, |y − yc| ≤ R, R = depth·tan(asin(λ/2p)) with λ = Triangles::acceptance_wavelength, the common cone of all
/// colours, and xc, yc, depth of its centroid (lit_box). A triangle with a
/// side above R/2 is halved, across its longest side, until none is: each part lights the box of its own centroid.
/// Without a limit (pitch of half a wavelength or less) all pixels are lit.
///
/// @param limits parts above these limits are halved further, within the same box
/// @return       parts that light a pixel of the grid and have an amplitude, in the triangles' order
/// @throws Error for a triangle of more than 2^20 parts, such as one that nearly touches the panel, and for parts that
///               do
///               not fit in memory
std::vector<TrianglePart> cut_triangles(const Triangles& triangles, const Grid& grid, const PartLimits& limits);

/// Phases [rad] of the light from a part's corners at a place on the panel, relative to that of its centroid, and the
/// deviations from linear phase at the middles of sides 01, 12 and 02.
struct PartPhases {
  std::array<double, 3> corners, middles;
  std::array<double, 3> moduli;  ///< r/‖p − corner‖
};

inline PartPhases part_phases(const TrianglePart& part, double x, double y, double wavelength) {
  const double k = 2 * pi / wavelength;
  const Vec3 way{x - part.centroid.x, y - part.centroid.y, part.depth};
  const double r = length(way);
  PartPhases phases;
  for (size_t j = 0; j < 3; ++j) {
    const Vec3 s = part.offsets[j];
    const double rj = length(way - s);
    phases.corners[j] = k * (part.along[j] + (dot(s, s) - 2 * dot(way, s)) / (rj + r));
    phases.moduli[j] = r / rj;
  }
  for (size_t m = 0; m < 3; ++m) {  // ‖p − s‖ is convex: between corners light comes from nearer by ℓ²/8r
    const Vec3 side = part.offsets[m == 0 ? 1 : 2] - part.offsets[m == 1 ? 1 : 0];
    const double forward = dot(side, way) / r;
    phases.middles[m] = -k * (dot(side, side) - forward * forward) / (8 * r);
  }
  return phases;
}

/// The envelope E of a part for such phases: its amplitude and the bulge of its phase as quadratic polynomials, its
/// linear phase exact. With β the bulge, quadratic interpolation has an error of about β²/13 of E.
inline std::complex<double> envelope_of(const TrianglePart& part, const PartPhases& phases) {
  const CornerOrder o = order_corners(phases.corners.data());
  const int order[3] = {o.first, o.middle, o.last};
  double a[3];
  for (int j = 0; j < 3; ++j) a[j] = part.weights[size_t(order[j])] * phases.moduli[size_t(order[j])];
  Phasor<double> b[3];
  constexpr int sides[3][2] = {{0, 1}, {1, 2}, {0, 2}};
  for (int m = 0; m < 3; ++m) {
    const int i = order[sides[m][0]], j = order[sides[m][1]], side = i + j == 1 ? 0 : i + j == 3 ? 1 : 2;
    const double mean = (a[sides[m][0]] + a[sides[m][1]]) / 2, lag = phases.middles[size_t(side)];
    const double half = std::sin(lag / 2);
    b[m] = {-2 * mean * half * half, mean * std::sin(lag)};  // mean·(exp(i·lag) − 1)
  }
  const Phasor<double> e = combine(triangle_moments(phases.corners[size_t(order[0])], phases.corners[size_t(order[1])],
                                                    phases.corners[size_t(order[2])]),
                                   a, b);
  return {e.re, e.im};
}

inline std::complex<double> envelope_at(const TrianglePart& part, double x, double y, double wavelength) {
  return envelope_of(part, part_phases(part, x, y, wavelength));
}

/// Field of a part at a place on the panel for an envelope there, without regard to its box.
inline std::complex<double> part_with(const TrianglePart& part, double x, double y, double wavelength,
                                      std::complex<double> envelope) {
  const double dx = x - part.centroid.x, dy = y - part.centroid.y, rho2 = dx * dx + dy * dy;
  const double beyond = rho2 / (std::sqrt(rho2 + part.depth * part.depth) + part.depth);
  return cis_cycles(part.start_cycles + beyond / wavelength) * envelope / (part.depth + beyond);
}

inline std::complex<double> part_at(const TrianglePart& part, double x, double y, double wavelength) {
  return part_with(part, x, y, wavelength, envelope_at(part, x, y, wavelength));
}

/// The same envelope from 2^halvings pieces of the part; its error falls sixteenfold with every two halvings.
std::complex<double> fine_envelope_at(const TrianglePart& part, double x, double y, double wavelength, int halvings);

inline std::complex<double> fine_part_at(const TrianglePart& part, double x, double y, double wavelength) {
  return part_with(part, x, y, wavelength, fine_envelope_at(part, x, y, wavelength, 4));
}

// A part of a triangle inside a tile of the panel. The wave of its centroid is split into a column times a row, as in
// sum_tiled. Its envelope is a polynomial of degree 3 in the column and in the row, interpolated at Chebyshev nodes.
// Row l of the polynomial is a wave of its own: column factor × Σₖ Cₗₖ·Tₖ, times row factor × Tₗ. A part adds one to
// four terms to the matrix product, fewer where the envelope is smooth or faint.

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
