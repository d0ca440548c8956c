#include "holotrace/wave/triangles/triangle_part.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"

namespace holotrace {
namespace {

// The longest side by a given measure; side 0 joins corners 0 and 1, side 1 joins 1 and 2, side 2 joins 0 and 2.
template <class Corners, class Measure>
std::pair<int, double> longest_side(const Corners& corners, const Measure& measure) {
  const double sides[3] = {measure(corners[1] - corners[0]), measure(corners[2] - corners[1]),
                           measure(corners[2] - corners[0])};
  const int side = int(std::max_element(sides, sides + 3) - sides);
  return {side, sides[side]};
}

struct Corners {
  std::array<Vec3, 3> at;
  std::array<float, 3> amplitudes;
  Vec3 operator[](size_t i) const { return at[i]; }
};

std::array<Corners, 2> bisect(const Corners& c, int side) {
  const size_t i = side == 1 ? 1 : 0, j = side == 0 ? 1 : 2;
  const Vec3 middle = (c.at[i] + c.at[j]) / 2;
  const float amplitude = (c.amplitudes[i] + c.amplitudes[j]) / 2;
  Corners first = c, second = c;
  first.at[j] = second.at[i] = middle;
  first.amplitudes[j] = second.amplitudes[i] = amplitude;
  return {first, second};
}

class Cutter {
 public:
  Cutter(const Triangles& triangles, const Grid& grid, const PartLimits& limits)
      : wavelength_(triangles.wavelength),
        grid_(grid),
        limits_(limits),
        tangent_(acceptance_tangent(triangles.acceptance_wavelength(), grid.pitch)) {}

  template <class Visit>
  void cut(const Triangle& t, const Visit& visit) const {
    whole(t, {t.corners, t.amplitudes}, visit);
  }

  TrianglePart prepare(const Triangle& t, const Corners& c, const PixelBox& box) const {
    const Vec3 centre = (c.at[0] + c.at[1] + c.at[2]) / 3, of_all = centroid(t), e = t.direction;
    TrianglePart part{centre, -centre.z, {}, {}, {}, 0, box};
    for (size_t j = 0; j < 3; ++j) part.offsets[j] = c.at[j] - centre;
    const double area = std::abs(dot(cross(c.at[1] - c.at[0], c.at[2] - c.at[0]), e)) / 2;
    for (size_t j = 0; j < 3; ++j) {
      part.along[j] = dot(part.offsets[j], e);
      part.weights[j] = 2 * area / wavelength_ * c.amplitudes[j];
    }
    // φ(s)/2π − 1/4, plus the cycles of the depth that r is measured from.
    part.start_cycles = t.phase / (2 * pi) - 0.25 - cycle_fraction(-of_all.z / e.z, wavelength_) +
                        dot(centre - of_all, e) / wavelength_ + cycle_fraction(part.depth, wavelength_);
    part.start_cycles -= std::floor(part.start_cycles);
    return part;
  }

 private:
  // Whether neither the whole nor any part of it reaches a pixel, at whatever depth. Such surfaces are not cut further.
  bool misses_panel(const Corners& c) const {
    const auto [left, right] = std::minmax({c[0].x, c[1].x, c[2].x});
    const auto [low, high] = std::minmax({c[0].y, c[1].y, c[2].y});
    const double reach = -std::min({c[0].z, c[1].z, c[2].z}) * tangent_;
    const double half_x = grid_.width() / 2 + reach, half_y = grid_.height() / 2 + reach;
    return right < grid_.centre_x - half_x || left > grid_.centre_x + half_x || high < grid_.centre_y - half_y ||
           low > grid_.centre_y + half_y;
  }

  // Cuts until one box of lit pixels suits the whole part.
  template <class Visit>
  void whole(const Triangle& t, const Corners& c, const Visit& visit) const {
    if (misses_panel(c)) return;
    const Vec3 centre = (c.at[0] + c.at[1] + c.at[2]) / 3;
    const auto [side, size] = longest_side(c, [](Vec3 v) { return length(v); });
    if (size > -centre.z * tangent_ / 2) {
      for (const Corners& half : bisect(c, side)) whole(t, half, visit);
      return;
    }
    fine(t, c, lit_box({centre, 0, 0}, grid_, tangent_), visit);
  }

  template <class Visit>
  void fine(const Triangle& t, const Corners& c, const PixelBox& box, const Visit& visit) const {
    const double nearest = -std::max({c.at[0].z, c.at[1].z, c.at[2].z});
    const auto [side, across] = longest_side(c, [&](Vec3 v) { return length_across(v, tangent_); });
    const double slope = 2 * pi / wavelength_ * across / nearest;
    if (slope * across / 8 > limits_.bulge || slope > limits_.slope) {
      for (const Corners& half : bisect(c, side)) fine(t, half, box, visit);
      return;
    }
    visit(t, c, box);
  }

  double wavelength_;
  const Grid& grid_;
  PartLimits limits_;
  double tangent_;
};

}  // namespace

std::vector<TrianglePart> cut_triangles(const Triangles& triangles, const Grid& grid, const PartLimits& limits) {
  const Cutter cutter(triangles, grid, limits);
  constexpr int64_t most = int64_t(1) << 20;
  std::vector<TrianglePart> parts;
  for (size_t i = 0; i < triangles.triangles.size(); ++i) {
    int64_t count = 0;
    cutter.cut(triangles.triangles[i], [&](const Triangle& t, const Corners& c, const PixelBox& box) {
      require(
          ++count <= most,
          "expected triangles that need {} parts or fewer each, but triangle {} at depths from {} to {} needs more; "
          "move it away from the panel, or use smaller triangles",
          most, i, format_length(-std::max({t.corners[0].z, t.corners[1].z, t.corners[2].z})),
          format_length(-std::min({t.corners[0].z, t.corners[1].z, t.corners[2].z})));
      const bool is_dark = c.amplitudes == std::array<float, 3>{};
      if (!box.is_empty() && !is_dark) parts.push_back(cutter.prepare(t, c, box));
    });
    require_memory(double(parts.size() * sizeof(TrianglePart)), "the parts of the triangles");
  }
  return parts;
}

std::complex<double> fine_envelope_at(const TrianglePart& part, double x, double y, double wavelength, int halvings) {
  if (halvings == 0) return envelope_at(part, x, y, wavelength);
  const int side = longest_side(part.offsets, [](Vec3 v) { return length(v); }).first;
  const size_t i = side == 1 ? 1 : 0, j = side == 0 ? 1 : 2;
  TrianglePart first = part;
  for (double& weight : first.weights) weight /= 2;
  TrianglePart second = first;
  first.offsets[j] = second.offsets[i] = (part.offsets[i] + part.offsets[j]) / 2;
  first.along[j] = second.along[i] = (part.along[i] + part.along[j]) / 2;
  first.weights[j] = second.weights[i] = (part.weights[i] + part.weights[j]) / 4;
  return fine_envelope_at(first, x, y, wavelength, halvings - 1) +
         fine_envelope_at(second, x, y, wavelength, halvings - 1);
}

PartInTile part_in_tile(const TrianglePart& part, double x, double y, double half_x, double half_y, double wavelength) {
  const PartPhases phases = part_phases(part, x, y, wavelength);
  const CornerOrder o = order_corners(phases.corners.data());
  const size_t order[3] = {size_t(o.first), size_t(o.middle), size_t(o.last)};
  const double k = 2 * pi / wavelength;
  const Vec3 way{x - part.centroid.x, y - part.centroid.y, part.depth};
  const double r = length(way);
  PartInTile p;
  for (int j = 0; j < 3; ++j) {
    const size_t corner = order[j];
    const double rj = r / phases.moduli[corner];
    p.phase[j] = phases.corners[corner];
    p.slope_x[j] = k * ((way.x - part.offsets[corner].x) / rj - way.x / r);
    p.slope_y[j] = k * ((way.y - part.offsets[corner].y) / rj - way.y / r);
    p.amplitude[j] = part.weights[corner] * phases.moduli[corner];
  }
  constexpr int sides[3][2] = {{0, 1}, {1, 2}, {0, 2}};
  for (int m = 0; m < 3; ++m) {
    const size_t i = order[sides[m][0]], j = order[sides[m][1]], side = i + j == 1 ? 0 : i + j == 3 ? 1 : 2;
    const double mean = (p.amplitude[sides[m][0]] + p.amplitude[sides[m][1]]) / 2, lag = phases.middles[side];
    const double half = std::sin(lag / 2);
    p.bulge[m] = {-2 * mean * half * half, mean * std::sin(lag)};
  }
  p.gap = o.gap;
  p.gap_change = 0;
  for (int m = 0; m < 3; ++m) {
    const int i = sides[m][0], j = sides[m][1];
    p.gap_change = std::max(
        p.gap_change, std::abs(p.slope_x[i] - p.slope_x[j]) * half_x + std::abs(p.slope_y[i] - p.slope_y[j]) * half_y);
  }
  return p;
}

void expand_envelope(const PartInTile& part, double half_x, double half_y, EnvelopeCoefficients& c) {
  std::complex<double> at[envelope_nodes][envelope_nodes];
  for (int l = 0; l < envelope_nodes; ++l)
    for (int k = 0; k < envelope_nodes; ++k) {
      double phase[3];
      for (int j = 0; j < 3; ++j)
        phase[j] =
            part.phase[j] + part.slope_x[j] * envelope_node[k] * half_x + part.slope_y[j] * envelope_node[l] * half_y;
      // Not triangle_moments: over the whole tile the corners keep the order that they have at the centre.
      const TriangleMoments<double> m = moment_method(part) == MomentMethod::quotients
                                            ? moments_by_quotients(phase[0], phase[1], phase[2])
                                            : moments_by_series<30>(phase[0], phase[1], phase[2]);
      const Phasor<double> e = combine(m, part.amplitude, part.bulge);
      at[l][k] = {e.re, e.im};
    }
  const auto basis = [](int degree, int node) {  // (2 or 1)/4·T_degree(node)
    const double x = envelope_node[node];
    return (degree == 0 ? 0.5 : degree == 1 ? x : degree == 2 ? 2 * x * x - 1 : (4 * x * x - 3) * x) / 2;
  };
  for (int l = 0; l < envelope_nodes; ++l)
    for (int k = 0; k < envelope_nodes; ++k) {
      c[l][k] = 0;
      for (int m = 0; m < envelope_nodes; ++m)
        for (int n = 0; n < envelope_nodes; ++n) c[l][k] += at[m][n] * (basis(l, m) * basis(k, n));
    }
}

}  // namespace holotrace
