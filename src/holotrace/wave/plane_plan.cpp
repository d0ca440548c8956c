#include "holotrace/wave/plane_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/wave/cost_model.h"
#include "holotrace/wave/tile_error.h"

namespace holotrace {
namespace {

constexpr std::array<int, 3> tiles{240, 120, 60};  // sides that divide 1080p and 4K panels, of good FFT length

struct Range {
  double least, greatest;
};

// Curvatures of a wave's light where its box lies: (1 − ρ²/2r²)/λr falls from the axis to the box's corner.
Range curvatures(double depth, double wavelength, double tangent) {
  const double rho2 = 2 * tangent * tangent * depth * depth, r = std::sqrt(rho2 + depth * depth);
  return {(1 - rho2 / (2 * r * r)) / (wavelength * r), 1 / (wavelength * depth)};
}

// Boxes end at the tangent of the panel's acceptance; half a tile beyond a tile's centre may lie within.
double reach_tangent(double wavelength, double pitch) { return 1.2 * acceptance_tangent(wavelength, pitch); }

// Slabs of equal steps of 1/depth, from the nearest wave to the farthest.
struct Slabs {
  DepthRange depths;
  int count;

  double step() const { return (1 / depths.nearest - 1 / depths.farthest) / count; }
  int of(double depth) const {
    return step() > 0 ? std::clamp(int((1 / depths.nearest - 1 / depth) / step()), 0, count - 1) : 0;
  }
  Slab slab(int index, double wavelength, double pitch) const {
    const double tangent = reach_tangent(wavelength, pitch), most = 1 / depths.nearest;
    const double greatest = curvatures(1 / (most - index * step()), wavelength, tangent).greatest;
    const double least = curvatures(1 / (most - (index + 1) * step()), wavelength, tangent).least;
    return {0, 0, (greatest + least) / 2, (greatest - least) / 2};
  }
};

DepthRange depths_of(const std::vector<PreparedWave>& waves) {
  const auto [nearest, farthest] = std::minmax_element(
      waves.begin(), waves.end(), [](const PreparedWave& a, const PreparedWave& b) { return a.depth < b.depth; });
  return {nearest->depth, farthest->depth};
}

// A box's pixels over the tile's, the tiles that its edges cut, and those that its corners lie in.
struct TileCounts {
  double whole = 0, partial = 0, corners = 0;
};

TileCounts count_tiles(const std::vector<PreparedWave>& waves, const PixelBox& bounds, int tile) {
  TileCounts counts;
  for (const PreparedWave& w : waves) {
    const double width = w.box.x1 - w.box.x0, height = w.box.y1 - w.box.y0;
    counts.whole += width * height / (double(tile) * tile);
    const int edges_x = (w.box.x0 > bounds.x0) + (w.box.x1 < bounds.x1);
    const int edges_y = (w.box.y0 > bounds.y0) + (w.box.y1 < bounds.y1);
    counts.corners += edges_x * edges_y;
    counts.partial += (edges_x * height + edges_y * width) / tile;
  }
  return counts;
}

}  // namespace

bool suits_planes(const PreparedWave& wave, double wavelength, double pitch) {
  return 2 * wave.depth * acceptance_tangent(wavelength, pitch) >= 4 * tiles.back() * pitch;
}

PlaneWaves sort_waves(std::vector<PreparedWave> waves, const PlanesPlan& plan, double wavelength, double pitch) {
  const DepthRange depths = depths_of(waves);
  const Slabs slabs{depths, plan.slabs};
  // Rows of eight cells of a grid: what a few waves in turn are spread over stays in the cache.
  const double cell = wavelength * std::sqrt(depths.nearest * depths.farthest) / (2 * plan.tile * pitch);
  struct Key {
    int slab, row;
    double x;
    uint32_t index;
    auto operator<=>(const Key&) const = default;
  };
  std::vector<Key> keys;
  for (size_t i = 0; i < waves.size(); ++i)
    keys.push_back({slabs.of(waves[i].depth), int(std::floor(waves[i].y / (8 * cell))), waves[i].x, uint32_t(i)});
  std::sort(keys.begin(), keys.end());
  PlaneWaves sorted;
  sorted.waves.reserve(waves.size());
  for (size_t i = 0; i < keys.size(); ++i) {
    if (i == 0 || keys[i].slab != keys[i - 1].slab) {
      sorted.slabs.push_back(slabs.slab(keys[i].slab, wavelength, pitch));
      sorted.slabs.back().first = i;
    }
    sorted.slabs.back().last = i + 1;
    sorted.waves.push_back(waves[keys[i].index]);
  }
  return sorted;
}

namespace {

// The planes of a slab, at a wave's curvature: their chirps interpolated at u² + v², or at v² alone.
std::complex<double> interpolate(const Slab& slab, const PlaneTables& t, double kappa, double square) {
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

// What a plan makes of a wave (x, y) from the tile's reference, at (u, v) from there, over what the wave is.
std::complex<double> in_tile(double x, double y, double depth, double u, double v, const Slab& slab,
                             const PlaneTables& t) {
  const double half = t.plan.tile * t.pitch / 2, linear = (0.6 + 1.0 / 3) * half * half;
  const double rho2 = x * x + y * y, r0 = std::sqrt(rho2 + depth * depth);
  const double r = std::sqrt((x + u) * (x + u) + (y + v) * (y + v) + depth * depth);
  const double kappa = (1 - rho2 / (2 * r0 * r0)) / (t.wavelength * r0), square = u * u + v * v;
  // Cycles beyond those of the plane wave.
  const double exact = (r - r0) / t.wavelength - (x * u + y * v) / (t.wavelength * r0) * (1 - linear / (2 * r0 * r0));
  std::complex<double> model = interpolate(slab, t, kappa, square) * (r / r0) * std::polar(1.0, -2 * pi * exact);
  if (t.plan.is_corrected)
    model *= std::complex<double>(
        1 - (x * u + y * v) / (r0 * r0),
        -2 * pi / (t.wavelength * r0 * r0 * r0) *
            (x * y * u * v + (x * x - y * y) / 4 * (u * u - v * v) + (x * u + y * v) * (square - linear) / 2));
  return model;
}

// The same in a strip that is across x: u from the strip's middle, v from the tile's reference.
std::complex<double> in_strip(double x, double y, double depth, double u, double v, const Slab& slab,
                              const PlaneTables& t) {
  const double half = t.plan.tile * t.pitch / 2, linear = 0.6 * half * half;
  const double rest = y * y + depth * depth, r0 = std::sqrt(x * x + rest), across = std::sqrt((x + u) * (x + u) + rest);
  const double r = std::sqrt((x + u) * (x + u) + (y + v) * (y + v) + depth * depth);
  const double kappa = (1 - y * y / (r0 * r0)) / (t.wavelength * r0);
  const double exact = (r - across) / t.wavelength - y * v / (t.wavelength * r0) * (1 - linear / (2 * r0 * r0));
  return interpolate(slab, t, kappa, v * v) * (r / across) * std::polar(1.0, -2 * pi * exact);
}

// Of a tile's line, its place from the middle of its strip.
int in_own_strip(int line) { return line % strip_width - strip_width / 2; }

}  // namespace

SplitEnergies measure_planes(const std::vector<DrawnPixel>& pixels, const DepthRange& depths, const Grid& grid,
                             const PixelBox& bounds, double wavelength, const PlanesPlan& plan) {
  const PlaneTables tables(plan, wavelength, grid.pitch);
  const Slabs slabs{depths, plan.slabs};
  SplitEnergies energies;
  for (const auto& [w, column, row, density] : pixels) {
    const Slab slab = slabs.slab(slabs.of(w.depth), wavelength, grid.pitch);
    const int i = (column - bounds.x0) % plan.tile, j = (row - bounds.y0) % plan.tile;
    const PixelBox tile{column - i, std::min(column - i + plan.tile, bounds.x1), row - j,
                        std::min(row - j + plan.tile, bounds.y1)};
    const bool all_x = w.box.x0 <= tile.x0 && w.box.x1 >= tile.x1, all_y = w.box.y0 <= tile.y0 && w.box.y1 >= tile.y1;
    const double dx = grid.x(column) - w.x, dy = w.y - grid.y(row);  // y down
    const double u = (i - plan.tile / 2) * grid.pitch, v = (j - plan.tile / 2) * grid.pitch;
    std::complex<double> model = 1;  // of the direct sum
    if (all_x && all_y) model = in_tile(dx - u, dy - v, w.depth, u, v, slab, tables);
    const double across_u = in_own_strip(i) * grid.pitch, across_v = in_own_strip(j) * grid.pitch;
    if (plan.has_strips && !all_x && all_y) model = in_strip(dx - across_u, dy - v, w.depth, across_u, v, slab, tables);
    if (plan.has_strips && all_x && !all_y) model = in_strip(dy - across_v, dx - u, w.depth, across_v, u, slab, tables);
    const double d2 = w.depth * w.depth, energy = w.amplitude * w.amplitude * (d2 / (dx * dx + dy * dy + d2)) / density;
    energies.error += energy * std::norm(model - 1.0);
    energies.waves += energy;
  }
  return energies;
}

namespace {

SummationWork work_of(const PlanesPlan& plan, const TileCounts& counts, double tiles_of_panel, const TilePlan& direct) {
  const double planes = plan.nodes, m = 2 * plan.tile, cells = m + 2 * PlaneTables::margin;
  // Grids that the second cache does not hold take three times as long to add to.
  const double cache = planes * cells * cells * 8 < 2e6 ? 1 : 3;
  const double per_wave = cache * planes * plan.width * (plan.width <= 4 ? 4 : GriddingKernel::greatest_width);
  // Half of a tile's strips at most are made up for, a quarter on average, and one more in part.
  const double entries = !plan.has_strips ? 0 : counts.partial * (1.5 + plan.tile / (4.0 * strip_width));
  const double transforms = tiles_of_panel * plan.slabs * planes * (plan.is_corrected ? 5 : 1);
  const double strips = std::min(entries, tiles_of_panel * plan.slabs * 2 * std::ceil(double(plan.tile) / strip_width));
  const double lines = transforms * 1.5 * m + strips * planes * strip_width;  // that are transformed
  SummationWork work{.plane_waves = counts.whole + entries,
                     .spreads = counts.whole * per_wave + entries * planes * plan.width * strip_width,
                     .fft_operations = lines * fft_operations(m),
                     .samples = lines * 2 * m};
  const double in_tiles = counts.corners + (plan.has_strips ? 0 : counts.partial);
  return work + in_tiles * plan.tile * plan.tile / 2 * tile_work(direct);
}

}  // namespace

PlanesChoice choose_planes(const std::vector<PreparedWave>& waves, const TilePlan& direct, const Grid& grid,
                           const PixelBox& bounds, double wavelength, double tolerance, double coherence,
                           double most_seconds) {
  PlanesChoice best{};
  // Many plans are looked at: an eighth of the pixels tells their errors to a few percent.
  std::vector<DrawnPixel> pixels;
  const std::vector<DrawnPixel> drawn = draw_pixels(waves);
  for (size_t i = 0; i < drawn.size(); ++i)
    if (i % 16 < 2) pixels.push_back(drawn[i]);  // one of each kind of draw
  const DepthRange depths = depths_of(waves);
  const double goal = tolerance * std::sqrt(coherence) / 1.25;
  const SummationRates rates = summation_rates();
  const auto offer = [&](const PlanesPlan& plan, double error, const SummationWork& work,
                         const SplitEnergies& energies) {
    const double seconds = predict_seconds(work, rates, 1);
    const bool meets = error <= goal;
    const bool is_better = meets != best.meets_tolerance ? meets : meets ? seconds < best.seconds : error < best.error;
    if (is_better || best.seconds == 0) best = {plan, error / std::sqrt(coherence), work, seconds, energies, meets};
  };
  for (const int tile : tiles) {
    const TileCounts counts = count_tiles(waves, bounds, tile);
    const double area = double(bounds.x1 - bounds.x0) * (bounds.y1 - bounds.y0),
                 of_panel = area / (double(tile) * tile);
    for (const auto& [is_corrected, has_strips] : {std::pair{false, true}, {true, true}, {true, false}})
      for (int slabs = 1; slabs <= 64; slabs *= 2) {
        double before = 1e9;
        for (int nodes = 1; nodes <= 8; ++nodes) {
          PlanesPlan plan{tile, 2, nodes, slabs, is_corrected, has_strips};
          // Nothing dearer than what is known to do.
          if (predict_seconds(work_of(plan, counts, of_panel, direct), rates, 1) >=
              (best.meets_tolerance ? best.seconds : most_seconds))
            break;
          const SplitEnergies energies = measure_planes(pixels, depths, grid, bounds, wavelength, plan);
          const double planes = energies.waves > 0 ? std::sqrt(energies.error / energies.waves) : 0;
          for (int width = 2; width <= GriddingKernel::greatest_width; ++width) {
            plan.width = width;
            const double error = std::sqrt(planes * planes + 2 * std::pow(gridding_error(width), 2) +
                                           std::pow(rounding_error(TileProducts::single), 2));
            offer(plan, error, work_of(plan, counts, of_panel, direct), energies);
            if (error <= goal) break;
          }
          if (planes <= goal / 2 || planes > 0.98 * before) break;  // more planes bring nothing
          before = planes;
        }
      }
  }
  return best;
}

}  // namespace holotrace
