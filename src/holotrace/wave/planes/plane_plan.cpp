#include "holotrace/wave/planes/plane_plan.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/wave/planes/plane_correction_kernel.h"
#include "holotrace/wave/planes/plane_tile.h"
#include "holotrace/wave/shared/cost_model.h"

namespace holotrace {
namespace {

// exp(i2π·cycles) within 1e-7: errors of plans are larger.
std::complex<double> rough_cis(double cycles) {
  const auto angle = float(2 * pi * (cycles - std::nearbyint(cycles)));
  return {std::cos(angle), std::sin(angle)};
}

// The chirps of a slab's nodes, interpolated to a wave's curvature; square is u² + v², or v² in a strip.
std::complex<double> interpolate(const Slab& slab, const PlanesModel& t, double kappa, double square) {
  const double tau = (kappa - slab.centre) / slab.half;
  std::complex<double> sum = 0;
  for (size_t q = 0; q < t.nodes.size(); ++q) {
    double weight = 1 / double(t.denominators[q]);
    for (size_t m = 0; m < t.nodes.size(); ++m)
      if (m != q) weight *= tau - t.nodes[m];
    sum += weight * rough_cis((slab.centre + slab.half * t.nodes[q]) * square / 2);
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
  std::complex<double> model = interpolate(slab, t, kappa, square) * (r / r0) * rough_cis(-exact);
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
  return interpolate(slab, t, kappa, v * v) * (r / across) * rough_cis(-exact);
}

// Position of a line of the tile, counted from the middle of its strip.
int in_own_strip(int line) { return line % strip_width - strip_width / 2; }

}  // namespace

SplitEnergies measure_planes(const std::vector<DrawnPixel>& pixels, const WaveDepths& depths, const Grid& grid,
                             const PixelBox& bounds, double wavelength, const PlanesPlan& plan) {
  const PlanesModel model(plan, wavelength, grid.pitch);
  const Slabs slabs{depths, plan.slabs};
  std::vector<Slab> of_slabs;
  for (int i = 0; i < plan.slabs; ++i) of_slabs.push_back(slabs.slab(i, wavelength, grid.pitch));
  return sum_energies(pixels, [&](const DrawnPixel& drawn) -> SplitEnergies {
    const PreparedWave& w = drawn.wave;
    const int column = drawn.column, row = drawn.row;
    const Slab& slab = of_slabs[size_t(slabs.of(w.depth))];
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
    const double d2 = w.depth * w.depth,
                 energy = w.amplitude * w.amplitude * (d2 / (dx * dx + dy * dy + d2)) / drawn.density;
    return {energy * error, energy};
  });
}

double rounding_error_of_planes(const PlanesPlan& plan) {
  return std::hypot(rounding_error(TileProducts::single), 5e-8 * plan.tile);
}

double gridding_error_of_planes(const PlanesPlan& plan, const PixelBox& bounds) {
  const auto energy = [&](double used) {
    const double error = gridding_error(plan.width, plan.oversampling, used);
    return error * error;
  };
  const auto along = [&](int pixels) {
    const int rest = pixels % plan.tile;
    return ((pixels - rest) * energy(1) + (rest > 0 ? rest * energy(double(rest) / plan.tile) : 0)) / pixels;
  };
  return std::sqrt(along(bounds.x1 - bounds.x0) + along(bounds.y1 - bounds.y0));
}

namespace {

constexpr std::array<int, 3> tiles{240, 120, 60};  // sides that divide 1080p and 4K panels and suit FFTs

PlanesCounts count_tiles(PreparedWaves waves, const PixelBox& bounds, int tile) {
  PlanesCounts counts;
  counts.tiles = double(bounds.x1 - bounds.x0) * (bounds.y1 - bounds.y0) / (double(tile) * tile);
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

// In units of the waves of whole tiles: the work of an entry of a strip besides its products, and that of its products for
// each of its nodes and cells, which stay in registers. Measured.
constexpr double entry_waves = 2.5, entry_spreads = 8;

double spreads_per_entry(const PlanesPlan& plan) { return entry_spreads * plan.nodes * std::max(plan.width, 4); }

// Lines of a tile that are computed by tiles of `side`, of which its lines up to an edge anywhere within are lit: on average
// half of them and half of a `side`.
double lines_to_edge(int tile, int side) { return 0.5 * side * (std::ceil(double(tile) / side) + 1); }

SummationWork work_of_corner(const TilePlan& direct, int tile) {
  const auto [columns, rows] = direct.shape;
  return lines_to_edge(tile, columns) * lines_to_edge(tile, rows) * tile_work(direct);
}

SummationWork work_of(const PlanesPlan& plan, const PlanesCounts& counts, const TilePlan& direct) {
  const double nodes = plan.nodes, slots = std::bit_ceil(unsigned(plan.nodes));
  const double m = plan.transform(), cells = m + 2 * PlanesTables::margin;
  // At most half of a tile's strips need an entry, a quarter on average, and one more partly lit strip.
  const double entries = !plan.has_strips ? 0 : counts.partial * (1.5 + plan.tile / (4.0 * strip_width));
  const double grids = counts.tiles * plan.slabs;
  const double lines_of_grids = cells * slots * (plan.is_corrected ? 3 : 1) +
                                plan.tile * nodes * (plan.is_corrected ? corrected_terms : 1);  // plane_tile.h
  const double strips = std::min(entries, counts.tiles * plan.slabs * 2 * std::ceil(double(plan.tile) / strip_width));
  const double lines = grids * lines_of_grids + strips * nodes * strip_width;  // lines to transform
  constexpr double from_memory = 1.6;  // measured: tiles of a panel take so much longer than the one that is timed
  SummationWork work{
      .plane_waves = from_memory * (counts.whole + entry_waves * entries),
      .spreads = from_memory * (counts.whole * spreads_per_wave(plan) + entries * spreads_per_entry(plan)),
      .fft_operations = lines * fft_operations(m),
      .samples = lines * 2 * m};
  const TilePlan of_corners = plan_of_corners(direct, plan.tile);
  work = work + counts.corners * work_of_corner(of_corners, plan.tile);
  if (plan.has_strips) return work;
  // An edge along either axis is as likely.
  const auto [columns, rows] = of_corners.shape;
  const double pixels = plan.tile * (lines_to_edge(plan.tile, columns) + lines_to_edge(plan.tile, rows)) / 2;
  return work + counts.partial * pixels * tile_work(of_corners);
}

constexpr int most_slabs = 64, most_nodes = 8;
constexpr int most_nodes_of_large_tiles = 4;  // whose grids take 8 MB then, with their transforms 21 MB

// Evaluates plans and keeps the fastest that meets the goal, or else the most accurate.
class PlanSearch {
 public:
  PlanSearch(PreparedWaves waves, const std::vector<DrawnPixel>& drawn, const PlanesCost& cost, const SumGoal& goal,
             double most_seconds)
      : waves_(waves),
        cost_(cost),
        grid_(goal.grid),
        bounds_(goal.bounds),
        wavelength_(goal.wavelength),
        goal_(goal.tolerance * std::sqrt(goal.coherence) / 1.25),
        most_seconds_(most_seconds),
        depths_(depths_of(waves)) {
    while (least_width_ < GriddingKernel::greatest_width && std::sqrt(2) * gridding_error(least_width_) > goal_)
      ++least_width_;
    // Many plans are compared; an eighth of the pixels gives their errors to a few percent.
    pixels_ = some_of(drawn, 8);
    some_pixels_ = some_of(pixels_, 8);
  }

  const PlanesChoice& best() const { return best_; }

  void look_at_tiles(int tile) {
    counts_ = count_tiles(waves_, bounds_, tile);
    using Kinds = std::vector<std::pair<bool, bool>>;  // is_corrected, has_strips
    for (const auto& [is_corrected, has_strips] :
         cost_.has_strips ? Kinds{{false, true}, {true, true}, {true, false}} : Kinds{{false, false}, {true, false}}) {
      PlanesPlan plan{tile, least_width_, 1, 1, is_corrected, has_strips};
      if (!is_worth(plan)) continue;
      // If the error stays above the goal with the most nodes, it does not come from their number: skip these plans.
      most_nodes_ = tile > 120 ? most_nodes_of_large_tiles : most_nodes;
      plan = {tile, 8, most_nodes_, most_slabs, is_corrected, has_strips};
      if (!(offer(plan) <= goal_)) continue;
      for (plan.slabs = 1; plan.slabs <= most_slabs; plan.slabs *= 2) look_at_nodes(plan);
    }
  }

 private:
  bool is_worth(PlanesPlan plan) const {
    const std::vector<double> grids = grids_for(plan);
    return std::any_of(grids.begin(), grids.end(), [&](double oversampling) {
      plan.oversampling = oversampling;
      return seconds(plan) < (best_.meets_tolerance ? best_.seconds : most_seconds_);
    });
  }

  // Corrections cost as much on a coarser grid, which the model of the cost does not know: it would choose them too often.
  std::vector<double> grids_for(const PlanesPlan& plan) const {
    return plan.is_corrected ? std::vector<double>{2} : cost_.oversamplings;
  }

  double seconds(const PlanesPlan& plan) const { return cost_.seconds(plan, counts_); }

  void look_at_nodes(PlanesPlan plan) {
    for (plan.nodes = 1; plan.nodes <= most_nodes_; ++plan.nodes) {
      plan.width = least_width_;
      if (!is_worth(plan) || offer(plan) <= goal_ / 2) return;
    }
  }

  // Tries the plan with each grid, and with the narrowest kernel that meets the goal there. Returns the error without gridding.
  double offer(PlanesPlan plan) {
    const auto energies_at = [&](const std::vector<DrawnPixel>& pixels) {
      return measure_planes(pixels, depths_, grid_, bounds_, wavelength_, plan);
    };
    SplitEnergies energies = energies_at(some_pixels_);
    if (energies.relative_error() <= beyond_doubt * goal_ || best_.seconds == 0) energies = energies_at(pixels_);
    const double without_gridding = energies.relative_error();
    for (const double oversampling : grids_for(plan)) {
      PlanesPlan with_grid = plan;
      with_grid.oversampling = oversampling;
      const auto error = [&] {
        return std::hypot(without_gridding, gridding_error_of_planes(with_grid, bounds_),
                          rounding_error_of_planes(with_grid));
      };
      while (with_grid.width < GriddingKernel::greatest_width && error() > goal_) ++with_grid.width;
      take_if_better({with_grid, error(), seconds(with_grid), energies, error() <= goal_});
    }
    return without_gridding;
  }

  void take_if_better(const PlanesChoice& choice) {
    const bool is_better = choice.meets_tolerance != best_.meets_tolerance
                               ? choice.meets_tolerance
                               : (choice.meets_tolerance ? choice.seconds < best_.seconds : choice.error < best_.error);
    if (is_better || best_.seconds == 0) best_ = choice;
  }

  PreparedWaves waves_;
  const PlanesCost& cost_;
  const Grid grid_;
  const PixelBox bounds_;
  const double wavelength_, goal_, most_seconds_;
  const WaveDepths depths_;
  std::vector<DrawnPixel> pixels_, some_pixels_;
  PlanesCounts counts_;
  int least_width_ = 2, most_nodes_ = most_nodes;
  PlanesChoice best_;
};

}  // namespace

double least_depth_for_planes(double wavelength, double pitch) {
  const double tangent = acceptance_tangent(wavelength, pitch);
  return tangent < 0.25 ? 2 * tiles.back() * pitch / tangent : std::numeric_limits<double>::infinity();
}

double spreads_per_wave(const PlanesPlan& plan) {
  const double width = std::max(plan.width, 4), cells_of_vector = 4;  // complex numbers of 8 floats
  return width * cells_of_vector * std::ceil(width * std::bit_ceil(unsigned(plan.nodes)) / cells_of_vector);
}

TilePlan plan_of_corners(const TilePlan& direct, int tile) {
  const SummationRates rates = summation_rates();
  const auto seconds = [&](const TilePlan& plan) { return predict_seconds(work_of_corner(plan, tile), rates, 1); };
  TilePlan best = direct;
  for (const TileShape& shape : tile_shapes) {
    const TilePlan plan{shape, direct.products};
    const bool is_within = shape.columns <= direct.shape.columns && shape.rows <= direct.shape.rows;
    if (is_within && can_run(plan) && seconds(plan) < seconds(best)) best = plan;
  }
  return best;
}

PlanesCost planes_cost_on_processor(const TilePlan& direct) {
  return {[direct, rates = summation_rates()](const PlanesPlan& plan, const PlanesCounts& counts) {
    return predict_seconds(work_of(plan, counts, direct), rates, 1);
  }};
}

PlanesChoice choose_planes(PreparedWaves waves, const std::vector<DrawnPixel>& drawn, const PlanesCost& cost,
                           const SumGoal& goal, double most_seconds) {
  PlanSearch search(waves, drawn, cost, goal, most_seconds);
  for (const int tile : tiles) search.look_at_tiles(tile);
  PlanesChoice best = search.best();
  best.error /= std::sqrt(goal.coherence);
  return best;
}

}  // namespace holotrace
