#include "holotrace/wave/planes/plane_error.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/wave/planes/plane_correction_kernel.h"

namespace holotrace {
namespace {

// The chirps of a slab's nodes, interpolated to a wave's curvature; square is u² + v², or v² in a strip.
std::complex<double> interpolate(const Slab& slab, const PlanesModel& t, double kappa, double square) {
  const double tau = (kappa - slab.centre) / slab.half;
  std::complex<double> sum = 0;
  for (size_t q = 0; q < t.nodes.size(); ++q) {
    double weight = 1 / double(t.denominators[q]);
    for (size_t m = 0; m < t.nodes.size(); ++m)
      if (m != q) weight *= tau - t.nodes[m];
    sum += weight * std::polar(1.0, pi * (slab.centre + slab.half * t.nodes[q]) * square);
  }
  return sum;
}

// r at (x2, y2) less r at (x, y), without the cancellation of two long distances.
double path_between(double x, double y, double x2, double y2, double depth) {
  return path_beyond_depth(x2 * x2 + y2 * y2, depth) - path_beyond_depth(x * x + y * y, depth);
}

// A pixel at (u, v) from the tile's reference pixel or from the middle of its strip. That place is at (x, y) from a
// wave of that depth [m].
struct PixelOfWave {
  double x, y, depth, u, v;
};

// The wave at a pixel as a plan computes it, over the exact wave there.
std::complex<double> in_tile(const PixelOfWave& pixel, const Slab& slab, const PlanesModel& t) {
  const auto [x, y, depth, u, v] = pixel;
  const double half = t.plan.tile * t.pitch / 2, linear = linear_of_cubic * half * half;
  const double rho2 = x * x + y * y, r0 = std::sqrt(rho2 + depth * depth);
  const double r = std::sqrt((x + u) * (x + u) + (y + v) * (y + v) + depth * depth);
  const double kappa = (1 - rho2 / (2 * r0 * r0)) / (t.wavelength * r0), square = u * u + v * v;
  // Cycles in addition to those of the plane wave.
  const double exact = path_between(x, y, x + u, y + v, depth) / t.wavelength -
                       (x * u + y * v) / (t.wavelength * r0) * (1 - linear / (2 * r0 * r0));
  std::complex<double> model = interpolate(slab, t, kappa, square) * (r / r0) * std::polar(1.0, -2 * pi * exact);
  if (t.plan.is_corrected) {
    const double f = x / (t.wavelength * r0), g = y / (t.wavelength * r0);
    const CorrectionTerms<double> terms{f, g, f * g, f * f - g * g};
    model *= 1.0 + correction_at(correction_for<double>(t.wavelength, 1 / r0, linear), terms, u, v);
  }
  return model;
}

// The same in a strip across x: u from the strip's middle, v from the tile's reference pixel.
std::complex<double> in_strip(const PixelOfWave& pixel, const Slab& slab, const PlanesModel& t) {
  const auto [x, y, depth, u, v] = pixel;
  const double half = t.plan.tile * t.pitch / 2, linear = linear_of_cube * half * half;
  const double rest = y * y + depth * depth, r0 = std::sqrt(x * x + rest), across = std::sqrt((x + u) * (x + u) + rest);
  const double r = std::sqrt((x + u) * (x + u) + (y + v) * (y + v) + depth * depth);
  const double kappa = (1 - y * y / (r0 * r0)) / (t.wavelength * r0);
  const double exact = path_between(x + u, y, x + u, y + v, depth) / t.wavelength -
                       y * v / (t.wavelength * r0) * (1 - linear / (2 * r0 * r0));
  return interpolate(slab, t, kappa, v * v) * (r / across) * std::polar(1.0, -2 * pi * exact);
}

// Position of a line of the tile, counted from the middle of its strip.
int in_own_strip(int line) { return line % strip_width - strip_width / 2; }

}  // namespace

SplitEnergies measure_planes(const std::vector<DrawnPixel>& pixels, const WaveDepths& depths, const Grid& grid,
                             const PixelBox& bounds, double wavelength, const PlanesPlan& plan) {
  const PlanesModel model(plan, wavelength, grid.pitch);
  const Slabs slabs{depths, plan.slabs};
  SplitEnergies energies;
  for (const auto& [drawn, column, row, density] : pixels) {
    const auto& w = drawn;  // a name that the lambda below can use
    const Slab slab = slabs.slab(slabs.of(w.depth), wavelength, grid.pitch);
    const int i = (column - bounds.x0) % plan.tile, j = (row - bounds.y0) % plan.tile;
    const PixelBox tile{column - i, std::min(column - i + plan.tile, bounds.x1), row - j,
                        std::min(row - j + plan.tile, bounds.y1)};
    const bool all_x = w.box.x0 <= tile.x0 && w.box.x1 >= tile.x1, all_y = w.box.y0 <= tile.y0 && w.box.y1 >= tile.y1;
    const double dx = grid.x(column) - w.x, dy = w.y - grid.y(row);  // y axis points down
    const double u = (i - plan.tile / 2) * grid.pitch, v = (j - plan.tile / 2) * grid.pitch;
    const auto tile_error = [&] { return std::norm(in_tile({dx - u, dy - v, w.depth, u, v}, slab, model) - 1.0); };
    double error = 0;  // error of the direct sum
    if (all_x && all_y) {
      error = tile_error();
    } else if (plan.has_strips && (all_x || all_y)) {
      const double across_u = in_own_strip(i) * grid.pitch, across_v = in_own_strip(j) * grid.pitch;
      error = std::norm((all_y ? in_strip({dx - across_u, dy - v, w.depth, across_u, v}, slab, model)
                               : in_strip({dy - across_v, dx - u, w.depth, across_v, u}, slab, model)) -
                        1.0);
      const int size = all_y ? tile.x1 - tile.x0 : tile.y1 - tile.y0;
      const int lit = all_y ? std::min(w.box.x1, tile.x1) - std::max(w.box.x0, tile.x0)
                            : std::min(w.box.y1, tile.y1) - std::max(w.box.y0, tile.y0);
      const bool reaches = std::abs(all_y ? dx - u : dy - v) <= model.tangent * w.depth;
      // A wave that lights more than half of a tile is spread over all of it; strips subtract it from the rest,
      // where the errors of both remain.
      if (reaches && 2 * lit > size) error = tile_error() + (tile_error() + error) * double(size - lit) / lit;
    }
    const double d2 = w.depth * w.depth, energy = w.amplitude * w.amplitude * (d2 / (dx * dx + dy * dy + d2)) / density;
    energies.error += energy * error;
    energies.waves += energy;
  }
  return energies;
}

double rounding_error_of_planes(const PlanesPlan& plan) {
  return std::hypot(rounding_error(TileProducts::single), 5e-8 * plan.tile);
}

}  // namespace holotrace
