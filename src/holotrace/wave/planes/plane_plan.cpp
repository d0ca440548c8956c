#include "holotrace/wave/planes/plane_plan.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "holotrace/data/acceptance.h"
#include "holotrace/wave/planes/plane_error.h"
#include "holotrace/wave/planes/plane_transform.h"
#include "holotrace/wave/shared/cost_model.h"

namespace holotrace {
namespace {

constexpr std::array<int, 3> tiles{240, 120, 60};  // sides that divide 1080p and 4K panels and suit FFTs

PlanesCounts count_tiles(const std::vector<PreparedWave>& waves, const PixelBox& bounds, int tile) {
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
  const double m = 2 * plan.tile, cells = m + 2 * PlanesTables::margin;
  // At most half of a tile's strips need an entry, a quarter on average, and one more partly lit strip.
  const double entries = !plan.has_strips ? 0 : counts.partial * (1.5 + plan.tile / (4.0 * strip_width));
  const double grids = counts.tiles * plan.slabs;
  const double lines_of_grids = cells * slots * (plan.is_corrected ? 3 : 1) +
                                m / 2 * nodes * (plan.is_corrected ? corrected_terms : 1);  // plane_transform.h
  const double strips = std::min(entries, counts.tiles * plan.slabs * 2 * std::ceil(double(plan.tile) / strip_width));
  const double lines = grids * lines_of_grids + strips * nodes * strip_width;  // lines to transform
  SummationWork work{.plane_waves = counts.whole + entry_waves * entries,
                     .spreads = counts.whole * spreads_per_wave(plan) + entries * spreads_per_entry(plan),
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

// Error of the gridding of a plane wave, over both axes.
double both_axes(int width) {
  static const auto errors = [] {
    std::array<double, GriddingKernel::greatest_width + 1> of_width{};
    for (int w = 2; w <= GriddingKernel::greatest_width; ++w) of_width[size_t(w)] = std::sqrt(2) * gridding_error(w);
    return of_width;
  }();
  return errors[size_t(width)];
}

// Evaluates plans and keeps the fastest that meets the goal, or else the most accurate.
class PlanSearch {
 public:
  PlanSearch(const std::vector<PreparedWave>& waves, const PlanesCost& cost, const SumGoal& goal, double most_seconds)
      : waves_(waves),
        cost_(cost),
        grid_(goal.grid),
        bounds_(goal.bounds),
        wavelength_(goal.wavelength),
        goal_(goal.tolerance * std::sqrt(goal.coherence) / 1.25),
        most_seconds_(most_seconds),
        depths_(depths_of(waves)) {
    // Many plans are compared; an eighth of the pixels gives their errors to a few percent.
    const std::vector<DrawnPixel> drawn = draw_pixels(waves);
    constexpr size_t pair = 2, share = 8;  // a pair has one draw of each kind
    for (size_t i = 0; i < drawn.size(); ++i)
      if (i % (pair * share) < pair) {
        pixels_.push_back(drawn[i]);
        pixels_.back().density /= share;
      }
  }

  const PlanesChoice& best() const { return best_; }

  void look_at_tiles(int tile) {
    counts_ = count_tiles(waves_, bounds_, tile);
    using Kinds = std::vector<std::pair<bool, bool>>;  // is_corrected, has_strips
    for (const auto& [is_corrected, has_strips] :
         cost_.has_strips ? Kinds{{false, true}, {true, true}, {true, false}} : Kinds{{false, false}, {true, false}}) {
      PlanesPlan plan{tile, 2, 1, 1, is_corrected, has_strips};
      if (!is_worth(plan)) continue;
      // If the error stays above the goal with the most nodes, it does not come from their number: skip these plans.
      most_nodes_ = tile > 120 ? most_nodes_of_large_tiles : most_nodes;
      plan = {tile, 8, most_nodes_, most_slabs, is_corrected, has_strips};
      if (!(offer(plan) <= goal_)) continue;
      for (plan.slabs = 1; plan.slabs <= most_slabs; plan.slabs *= 2) look_at_nodes(plan);
    }
  }

 private:
  bool is_worth(const PlanesPlan& plan) const {
    return seconds(plan) < (best_.meets_tolerance ? best_.seconds : most_seconds_);
  }

  double seconds(const PlanesPlan& plan) const { return cost_.seconds(plan, counts_); }

  void look_at_nodes(PlanesPlan plan) {
    for (plan.nodes = 1; plan.nodes <= most_nodes_; ++plan.nodes) {
      plan.width = 2;
      if (!is_worth(plan) || offer(plan) <= goal_ / 2) return;
    }
  }

  // Tries the plan with the narrowest kernel that meets the goal. Returns the error without gridding.
  double offer(PlanesPlan plan) {
    const SplitEnergies energies = measure_planes(pixels_, depths_, grid_, bounds_, wavelength_, plan);
    const double without_gridding = energies.waves > 0 ? std::sqrt(energies.error / energies.waves) : 0;
    const auto error = [&] {
      return std::hypot(without_gridding, both_axes(plan.width), rounding_error_of_planes(plan));
    };
    while (plan.width < GriddingKernel::greatest_width && error() > goal_) ++plan.width;
    const PlanesChoice choice{plan, error(), seconds(plan), energies, error() <= goal_};
    const bool is_better = choice.meets_tolerance != best_.meets_tolerance
                               ? choice.meets_tolerance
                               : (choice.meets_tolerance ? choice.seconds < best_.seconds : choice.error < best_.error);
    if (is_better || best_.seconds == 0) best_ = choice;
    return without_gridding;
  }

  const std::vector<PreparedWave>& waves_;
  const PlanesCost& cost_;
  const Grid grid_;
  const PixelBox bounds_;
  const double wavelength_, goal_, most_seconds_;
  const WaveDepths depths_;
  std::vector<DrawnPixel> pixels_;
  PlanesCounts counts_;
  int most_nodes_ = most_nodes;
  PlanesChoice best_;
};

}  // namespace

bool suits_planes(const PreparedWave& wave, double wavelength, double pitch) {
  if (wave.astigmatic) return false;
  const double tangent = acceptance_tangent(wavelength, pitch);
  return tangent < 0.25 && 2 * wave.depth * tangent >= 4 * tiles.back() * pitch;
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

PlanesChoice choose_planes(const std::vector<PreparedWave>& waves, const PlanesCost& cost, const SumGoal& goal,
                           double most_seconds) {
  PlanSearch search(waves, cost, goal, most_seconds);
  for (const int tile : tiles) search.look_at_tiles(tile);
  PlanesChoice best = search.best();
  best.error /= std::sqrt(goal.coherence);
  return best;
}

}  // namespace holotrace
