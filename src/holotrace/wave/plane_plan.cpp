#include "holotrace/wave/plane_plan.h"

#include <tbb/parallel_sort.h>

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
  tbb::parallel_sort(keys.begin(), keys.end());
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

namespace {

constexpr int most_slabs = 64, most_nodes = 8;

// Of the gridding of a plane wave in both axes.
double both_axes(int width) {
  static const auto errors = [] {
    std::array<double, GriddingKernel::greatest_width + 1> of_width{};
    for (int w = 2; w <= GriddingKernel::greatest_width; ++w) of_width[size_t(w)] = std::sqrt(2) * gridding_error(w);
    return of_width;
  }();
  return errors[size_t(width)];
}

// Looks at plans, and keeps the fastest that meets the goal, or the most accurate.
class PlanSearch {
 public:
  PlanSearch(const std::vector<PreparedWave>& waves, const TilePlan& direct, const Grid& grid, const PixelBox& bounds,
             double wavelength, double goal, double most_seconds)
      : waves_(waves),
        direct_(direct),
        grid_(grid),
        bounds_(bounds),
        wavelength_(wavelength),
        goal_(goal),
        most_seconds_(most_seconds),
        rates_(summation_rates()),
        depths_(depths_of(waves)) {
    // Many plans are looked at: an eighth of the pixels tells their errors to a few percent.
    const std::vector<DrawnPixel> drawn = draw_pixels(waves);
    for (size_t i = 0; i < drawn.size(); ++i)
      if (i % 16 < 2) pixels_.push_back(drawn[i]);  // one of each kind of draw
  }

  const PlanesChoice& best() const { return best_; }

  void look_at_tiles(int tile) {
    counts_ = count_tiles(waves_, bounds_, tile);
    tiles_of_panel_ = double(bounds_.x1 - bounds_.x0) * (bounds_.y1 - bounds_.y0) / (double(tile) * tile);
    for (const auto& [is_corrected, has_strips] : {std::pair{false, true}, {true, true}, {true, false}}) {
      PlanesPlan plan{tile, 2, 1, 1, is_corrected, has_strips};
      if (!is_worth(plan)) continue;
      // What many planes leave is what they cannot mend: more of them would be looked at in vain.
      plan = {tile, 8, most_nodes, most_slabs, is_corrected, has_strips};
      if (offer(plan) > goal_) continue;
      for (plan.slabs = 1; plan.slabs <= most_slabs; plan.slabs *= 2) look_at_nodes(plan);
    }
  }

 private:
  bool is_worth(const PlanesPlan& plan) const {
    return seconds(plan) < (best_.meets_tolerance ? best_.seconds : most_seconds_);
  }

  SummationWork work(const PlanesPlan& plan) const { return work_of(plan, counts_, tiles_of_panel_, direct_); }
  double seconds(const PlanesPlan& plan) const { return predict_seconds(work(plan), rates_, 1); }

  void look_at_nodes(PlanesPlan plan) {
    for (plan.nodes = 1; plan.nodes <= most_nodes; ++plan.nodes) {
      plan.width = 2;
      if (!is_worth(plan) || offer(plan) <= goal_ / 2) return;
    }
  }

  // Offers the plan with the narrowest kernel that does. Returns the error of its planes alone.
  double offer(PlanesPlan plan) {
    const SplitEnergies energies = measure_planes(pixels_, depths_, grid_, bounds_, wavelength_, plan);
    const double planes = energies.waves > 0 ? std::sqrt(energies.error / energies.waves) : 0;
    const auto error = [&] { return std::hypot(planes, both_axes(plan.width), rounding_error(TileProducts::single)); };
    while (plan.width < GriddingKernel::greatest_width && error() > goal_) ++plan.width;
    const PlanesChoice choice{plan, error(), work(plan), seconds(plan), energies, error() <= goal_};
    const bool is_better = choice.meets_tolerance != best_.meets_tolerance
                               ? choice.meets_tolerance
                               : (choice.meets_tolerance ? choice.seconds < best_.seconds : choice.error < best_.error);
    if (is_better || best_.seconds == 0) best_ = choice;
    return planes;
  }

  const std::vector<PreparedWave>& waves_;
  const TilePlan direct_;
  const Grid grid_;
  const PixelBox bounds_;
  const double wavelength_, goal_, most_seconds_;
  const SummationRates rates_;
  const DepthRange depths_;
  std::vector<DrawnPixel> pixels_;
  TileCounts counts_;
  double tiles_of_panel_ = 0;
  PlanesChoice best_;
};

}  // namespace

PlanesChoice choose_planes(const std::vector<PreparedWave>& waves, const TilePlan& direct, const Grid& grid,
                           const PixelBox& bounds, double wavelength, double tolerance, double coherence,
                           double most_seconds) {
  PlanSearch search(waves, direct, grid, bounds, wavelength, tolerance * std::sqrt(coherence) / 1.25, most_seconds);
  for (const int tile : tiles) search.look_at_tiles(tile);
  PlanesChoice best = search.best();
  best.error /= std::sqrt(coherence);
  return best;
}

}  // namespace holotrace
