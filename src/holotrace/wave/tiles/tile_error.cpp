#include "holotrace/wave/tiles/tile_error.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/tiles/packed_product.h"

namespace holotrace {

namespace {

SplitEnergies split_of(const PreparedWave& w, Vec3 centre, Vec3 pixel, double wavelength) {
  const double x0 = centre.x - w.x, y0 = centre.y - w.y, x = pixel.x - w.x, y = pixel.y - w.y, d2 = w.depth * w.depth;
  const double r = std::sqrt(x * x + y * y + d2), r0 = std::sqrt(x0 * x0 + y0 * y0 + d2);
  const double along_column = std::sqrt(x * x + y0 * y0 + d2), along_row = std::sqrt(x0 * x0 + y * y + d2);
  const auto beyond = [&](double a, double b) { return path_beyond_depth(a * a + b * b, w.depth); };
  const double phase = 2 * pi / wavelength * ((beyond(x, y) - beyond(x, y0)) - (beyond(x0, y) - beyond(x0, y0)));
  const double energy = w.amplitude * w.amplitude * (d2 / (r * r));
  return {energy * std::norm(std::polar(r * r0 / (along_column * along_row), -phase) - 1.0), energy};
}

SplitEnergies split_of_astigmatic(const PreparedWave& w, Vec3 centre, Vec3 pixel, double wavelength) {
  const AstigmaticWave& wave = w.astigmatic->wave;
  const auto here = wave.at(pixel), there = wave.at(centre);
  const auto slopes = wave.slopes(centre);
  double path = there.path - here.path, ratio = there.modulus / here.modulus;
  const auto add_axis = [&](const AxisSphere& sphere, double u) {
    const double t = u * (2 * sphere.x + u) / (sphere.r0 * sphere.r0), root = std::sqrt(1 + t);
    path += sphere.r0 * t / (1 + root);
    ratio /= root;
  };
  add_axis({slopes.x, slopes.xx}, pixel.x - centre.x);
  add_axis({slopes.y, slopes.yy}, pixel.y - centre.y);
  const double energy = std::pow(w.amplitude * here.modulus, 2);
  return {energy * std::norm(std::polar(ratio, 2 * pi * path / wavelength) - 1.0), energy};
}

}  // namespace

SplitEnergies measure_split(const std::vector<DrawnPixel>& pixels, const Grid& grid, const PixelBox& bounds,
                            double wavelength, TileShape tile) {
  return sum_energies(pixels, [&](const DrawnPixel& drawn) -> SplitEnergies {
    const auto& [wave, i, k, density] = drawn;
    // The tile's centre as sum_tiled places it: tiles start at the first pixel of the bounds.
    const Vec3 centre{grid.x(i - (i - bounds.x0) % tile.columns + (tile.columns - 1) / 2.0),
                      grid.y(k - (k - bounds.y0) % tile.rows + (tile.rows - 1) / 2.0), 0};
    const Vec3 pixel{grid.x(i), grid.y(k), 0};
    if (const auto [from, to] = lit_columns(wave, grid, k); i < from || i >= to) return {};
    const SplitEnergies split = (wave.astigmatic ? split_of_astigmatic : split_of)(wave, centre, pixel, wavelength);
    return {split.error / density, split.waves / density};
  });
}

double rounding_error(TileProducts products) {
  switch (products) {
    case TileProducts::bf16:
      return 3.2e-3;  // 2⁻⁹ at most per number, three products of two
    case TileProducts::split_bf16:
      return 1.2e-5;
    case TileProducts::single:
      break;
  }
  return 4e-6;
}

SummationWork tile_work(const TilePlan& plan) {
  const double pixels = double(plan.shape.columns) * plan.shape.rows;
  SummationWork work{.factors = (plan.shape.columns + plan.shape.rows) / pixels, .wave_tiles = 1 / pixels};
  if (plan.products == TileProducts::single) {
    work.multiply_adds = 3;
    return work;
  }
  const bool is_split = plan.products == TileProducts::split_bf16;
  work.bf16_multiply_adds = is_split ? 9 : 3;
  work.packings = work.factors * (is_split ? 2 : 1);
  return work;
}

// Packed products need blocks of 32 × 32.
bool can_run(const TilePlan& plan) {
  return plan.products == TileProducts::single || (packed_unit() != PackedUnit::none && plan.shape.rows >= 30);
}

namespace {

// Pairs of a wave and a tile that it meets, and pairs of a wave and any tile of a group that it meets.
struct TilesMet {
  double all = 0, in_groups = 0;
};

TilesMet tiles_met(PreparedWaves waves, TileShape shape, const PixelBox& bounds, size_t most = SIZE_MAX) {
  const size_t step = 1 + (std::max<size_t>(waves.size(), 1) - 1) / most;
  const auto met = [&](int first, int end, int side) { return double((end - 1) / side - first / side + 1); };
  const TileShape group = group_of_tiles(shape);
  TilesMet sum;
  size_t count = 0;
  for (size_t i = 0; i < waves.size(); i += step, ++count) {
    const PixelBox& box = waves[i].box;
    const int x0 = box.x0 - bounds.x0, x1 = box.x1 - bounds.x0, y0 = box.y0 - bounds.y0, y1 = box.y1 - bounds.y0;
    sum.all += met(x0, x1, shape.columns) * met(y0, y1, shape.rows);
    sum.in_groups += met(x0, x1, group.columns) * met(y0, y1, group.rows);
  }
  const double scale = count > 0 ? double(waves.size()) / double(count) : 0;
  const double tiles = double(group.columns / shape.columns) * (group.rows / shape.rows);
  return {sum.all * scale, sum.in_groups * tiles * scale};
}

SummationWork work_of(const TilesMet& met, const TilePlan& plan, const PixelBox& bounds) {
  const double pixels_of_tile = double(plan.shape.columns) * plan.shape.rows, pixels = double(bounds.pixels());
  SummationWork work = met.all * pixels_of_tile * tile_work(plan);
  // A tile also reads the waves that meet only other tiles of its group, it is begun, and its pixels are cleared and added to the
  // field. Measured, in units of a wave in a tile.
  constexpr double of_other_wave = 0.75, of_tile = 60, of_pixel = 0.13;
  work.wave_tiles +=
      of_other_wave * std::max(0.0, met.in_groups - met.all) + of_tile * pixels / pixels_of_tile + of_pixel * pixels;
  return work;
}

}  // namespace

TileShape group_of_tiles(TileShape tile) {
  // In small groups a tile reads few waves in vain, but all waves are compared with more groups. These are about as fast as
  // groups of 128 × 120, and keep more threads busy.
  constexpr int columns = 64, rows = 60;
  return {std::max(columns / tile.columns, 1) * tile.columns, std::max(rows / tile.rows, 1) * tile.rows};
}

double pixels_of_tiles(PreparedWaves waves, TileShape shape, const PixelBox& bounds) {
  return tiles_met(waves, shape, bounds).all * shape.columns * shape.rows;
}

SummationWork work_of_tiles(PreparedWaves waves, const TilePlan& plan, const PixelBox& bounds) {
  return work_of(tiles_met(waves, plan.shape, bounds), plan, bounds);
}

TileChoice choose_tile(PreparedWaves waves, const std::vector<DrawnPixel>& pixels, const SumGoal& goal) {
  TileChoice best{};
  double least = std::numeric_limits<double>::infinity();  // seconds of the best
  const SummationRates rates = summation_rates();
  const std::vector<DrawnPixel> some = some_of(pixels, 8);
  const auto energies_at = [&](const std::vector<DrawnPixel>& at, TileShape shape) {
    return measure_split(at, goal.grid, goal.bounds, goal.wavelength, shape);
  };
  for (const TileShape shape : tile_shapes) {
    constexpr size_t enough = 1024;  // waves, for 3 % of the work
    const TilesMet met = tiles_met(waves, shape, goal.bounds, enough);
    struct Offer {
      TilePlan plan;
      double seconds;
    };
    std::vector<Offer> offers;
    for (const TileProducts products : {TileProducts::bf16, TileProducts::split_bf16, TileProducts::single}) {
      const TilePlan plan{shape, products};
      if (can_run(plan)) offers.push_back({plan, predict_seconds(work_of(met, plan, goal.bounds), rates, 1)});
    }
    if (best.meets_tolerance && std::ranges::none_of(offers, [&](const Offer& o) { return o.seconds < least; }))
      continue;
    const double most = beyond_doubt * goal.tolerance * std::sqrt(goal.coherence);
    if (shape != tile_shapes.back() && energies_at(some, shape).relative_error() > most) continue;
    const SplitEnergies energies = energies_at(pixels, shape);
    const double split = energies.relative_error();
    for (const auto& [plan, seconds] : offers) {
      const double error = std::hypot(split, rounding_error(plan.products)) / std::sqrt(goal.coherence);
      const bool meets = 1.25 * error <= goal.tolerance;
      if (meets == best.meets_tolerance ? meets && seconds >= least : !meets) continue;
      best = {plan, error, energies, meets};
      least = seconds;
    }
  }
  return best;
}

}  // namespace holotrace
