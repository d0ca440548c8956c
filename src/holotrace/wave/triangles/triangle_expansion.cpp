#include <algorithm>
#include <cmath>

#include "holotrace/wave/triangles/triangle_tile.h"

namespace holotrace {

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
