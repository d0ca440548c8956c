#include "holotrace/wave/tiles/tile_error.h"

#include <algorithm>

#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/tiles/packed_product.h"

namespace holotrace {

namespace {

// At a pixel: the energies of the split's error, and of the wave.
struct SplitAt {
  double error, energy;
};

SplitAt split_of(const PreparedWave& w, Vec3 centre, Vec3 pixel, double wavelength) {
  const double x0 = centre.x - w.x, y0 = centre.y - w.y, x = pixel.x - w.x, y = pixel.y - w.y, d2 = w.depth * w.depth;
  const double r = std::sqrt(x * x + y * y + d2), r0 = std::sqrt(x0 * x0 + y0 * y0 + d2);
  const double along_column = std::sqrt(x * x + y0 * y0 + d2), along_row = std::sqrt(x0 * x0 + y * y + d2);
  const auto beyond = [&](double a, double b) { return path_beyond_depth(a * a + b * b, w.depth); };
  const double phase = 2 * pi / wavelength * ((beyond(x, y) - beyond(x, y0)) - (beyond(x0, y) - beyond(x0, y0)));
  const double energy = w.amplitude * w.amplitude * (d2 / (r * r));
  return {energy * std::norm(std::polar(r * r0 / (along_column * along_row), -phase) - 1.0), energy};
}

SplitAt split_of_astigmatic(const PreparedWave& w, Vec3 centre, Vec3 pixel, double wavelength) {
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
  SplitEnergies energies;
  for (const auto& [wave, i, k, density] : pixels) {
    // The tile's centre as sum_tiled places it: tiles start at the first pixel of the bounds.
    const Vec3 centre{grid.x(i - (i - bounds.x0) % tile.columns + (tile.columns - 1) / 2.0),
                      grid.y(k - (k - bounds.y0) % tile.rows + (tile.rows - 1) / 2.0), 0};
    const Vec3 pixel{grid.x(i), grid.y(k), 0};
    if (const auto [from, to] = lit_columns(wave, grid, k); i < from || i >= to) continue;
    const SplitAt split = (wave.astigmatic ? split_of_astigmatic : split_of)(wave, centre, pixel, wavelength);
    energies.error += split.error / density;
    energies.waves += split.energy / density;
  }
  return energies;
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

TileChoice choose_tile(const std::vector<DrawnPixel>& pixels, const SumGoal& goal) {
  TileChoice best{};
  const SummationRates rates = summation_rates();
  const auto seconds = [&](const TilePlan& plan) { return predict_seconds(tile_work(plan), rates, 1); };
  for (const TileShape shape : tile_shapes) {
    const SplitEnergies energies = measure_split(pixels, goal.grid, goal.bounds, goal.wavelength, shape);
    const double split = energies.waves > 0 ? std::sqrt(energies.error / energies.waves) : 0;
    for (const TileProducts products : {TileProducts::bf16, TileProducts::split_bf16, TileProducts::single}) {
      const TilePlan plan{shape, products};
      if (!can_run(plan)) continue;
      const double error = std::hypot(split, rounding_error(products)) / std::sqrt(goal.coherence);
      const bool meets = 1.25 * error <= goal.tolerance;
      const bool is_better =
          meets == best.meets_tolerance ? (meets ? seconds(plan) < seconds(best.plan) : true) : meets;
      if (is_better) best = {plan, error, energies, meets};
    }
    // Smaller tiles cost more: stop at the first shape that meets the tolerance in single precision.
    if (best.meets_tolerance &&
        1.25 * std::hypot(split, rounding_error(TileProducts::single)) <= goal.tolerance * std::sqrt(goal.coherence))
      break;
  }
  return best;
}

}  // namespace holotrace
