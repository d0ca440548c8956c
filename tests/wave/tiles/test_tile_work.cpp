#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/wave/sum_exact.h"
#include "holotrace/wave/tiles/tile_sum.h"
#include "support/fields.h"
#include "support/wavelengths.h"

namespace holotrace {
namespace {

using namespace literals;

constexpr PixelBox bounds{7, 7 + 301, 3, 3 + 170};  // not a multiple of any tile, and not from the corner

// Waves that light boxes drawn in the bounds: most of them small, some up to an edge, one the whole.
std::vector<PreparedWave> drawn_boxes(int count) {
  CounterRandom random(11, 0, 0);
  const auto range = [&](int first, int end) {
    const int size = end - first, length = 1 + int(std::pow(random.uniform(), 3) * (size - 1));
    const int start = first + int(random.uniform() * (size - length + 1));
    return std::pair{start, start + length};
  };
  std::vector<PreparedWave> waves;
  for (int n = 0; n < count; ++n) {
    const auto [x0, x1] = range(bounds.x0, bounds.x1);
    const auto [y0, y1] = range(bounds.y0, bounds.y1);
    waves.emplace_back().box = n == 0 ? bounds : PixelBox{x0, x1, y0, y1};
  }
  return waves;
}

struct Counted {
  double met = 0, cut = 0;
};

// Looks at every tile for every wave.
Counted count_tiles(const std::vector<PreparedWave>& waves, TileShape shape) {
  Counted counted;
  for (const PreparedWave& wave : waves)
    for (int y = bounds.y0; y < bounds.y1; y += shape.rows)
      for (int x = bounds.x0; x < bounds.x1; x += shape.columns) {
        const PixelBox tile = intersect({x, x + shape.columns, y, y + shape.rows}, bounds);
        const PixelBox lit = intersect(tile, wave.box);
        counted.met += !lit.is_empty();
        counted.cut += !lit.is_empty() && lit.pixels() < tile.pixels();
      }
  return counted;
}

TEST(TileWork, IsThatOfTheTilesThatTheWavesMeet) {
  std::vector<PreparedWave> waves = drawn_boxes(100);
  for (int n = 0; n < 2000; ++n) waves.emplace_back().box = bounds;  // so many that some batches have no edge
  for (const TileShape shape : tile_shapes) {
    const Counted counted = count_tiles(waves, shape);
    const double pixels = counted.met * shape.columns * shape.rows;
    EXPECT_EQ(pixels_of_tiles(waves, shape, bounds), pixels);
    const TilePlan plan{shape, TileProducts::single};
    const SummationWork work = work_of_tiles(waves, plan, bounds), of_pixel = tile_work(plan);
    EXPECT_DOUBLE_EQ(work.multiply_adds, pixels * of_pixel.multiply_adds);
    // One wave with an edge makes the factors of its batch twice the work: the share of batches that have one.
    const double share = 1 - std::pow(1 - counted.cut / counted.met, waves_of_batch);
    EXPECT_GT(share, 0);
    EXPECT_LT(share, 0.99);
    EXPECT_DOUBLE_EQ(work.factors, pixels * of_pixel.factors * (1 + share));
    EXPECT_DOUBLE_EQ(work.wave_tiles, counted.met);
  }
  EXPECT_EQ(work_of_tiles({}, {tile_shapes[0], TileProducts::single}, bounds).factors, 0);
}

TEST(TileWork, IsEstimatedFromSomeOfTheWaves) {
  const std::vector<PreparedWave> waves = drawn_boxes(20'000);
  const TilePlan plan{tile_shapes[3], TileProducts::single};
  const double all = work_of_tiles(waves, plan, bounds).multiply_adds;
  const double estimate = work_of_tiles(waves, plan, bounds, 1000).multiply_adds;
  EXPECT_NE(estimate, all);
  // Pixels of tiles vary between waves by about twice their mean: 2/√1000 = 6 %, and three times that.
  EXPECT_NEAR(estimate / all, 1, 0.2);
}

// Small tiles are summed in groups, and more waves than the cache holds (4096) in parts: every wave once in every tile.
TEST(SumTiles, OfManyWavesInSmallTilesIsTheSum) {
  const Grid grid{140, 50, 8_um};
  const PixelBox part{7, 137, 3, 48};
  const Sources sources = test::make_random_sources(9000, grid, green, 0.1_m, 0.2_m, 0.4);
  const FieldDouble exact = sum_exact(sources, grid);
  const std::vector<PreparedWave> waves = prepare_waves(sources, grid);
  for (const TileShape shape : {tile_shapes.back(), tile_shapes[6], tile_shapes.front()}) {
    Field field(grid, green);
    sum_tiles(waves, {grid, green}, {shape, TileProducts::single}, part, field.samples);
    double error = 0, energy = 0;
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i) {
        const bool is_inside = i >= part.x0 && i < part.x1 && j >= part.y0 && j < part.y1;
        if (!is_inside) {
          ASSERT_EQ(field.samples(j, i), std::complex<float>()) << i << ' ' << j;
          continue;
        }
        error += std::norm(std::complex<double>(field.samples(j, i)) - exact.samples(j, i));
        energy += std::norm(exact.samples(j, i));
      }
    // The split of these waves, 0.1 m away, errs by at most 4e-3 in the largest tiles; a wave that is left out by 1e-2.
    EXPECT_LT(std::sqrt(error / energy), 4e-3) << shape.columns << ' ' << shape.rows;
  }
}

}  // namespace
}  // namespace holotrace
