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

// Pairs of a wave and a tile that it meets, by looking at all of them.
double count_tiles(const std::vector<PreparedWave>& waves, TileShape shape) {
  double met = 0;
  for (const PreparedWave& wave : waves)
    for (int y = bounds.y0; y < bounds.y1; y += shape.rows)
      for (int x = bounds.x0; x < bounds.x1; x += shape.columns)
        met += !intersect({x, x + shape.columns, y, y + shape.rows}, intersect(bounds, wave.box)).is_empty();
  return met;
}

TEST(TileWork, IsThatOfTheTilesThatTheWavesMeet) {
  const std::vector<PreparedWave> waves = drawn_boxes(300);
  for (const TileShape shape : tile_shapes) {
    const double met = count_tiles(waves, shape), pixels = met * shape.columns * shape.rows;
    EXPECT_EQ(pixels_of_tiles(waves, shape, bounds), pixels);
    const TilePlan plan{shape, TileProducts::single};
    const SummationWork work = work_of_tiles(waves, plan, bounds), of_pixel = tile_work(plan);
    EXPECT_DOUBLE_EQ(work.multiply_adds, pixels * of_pixel.multiply_adds);
    EXPECT_DOUBLE_EQ(work.factors, pixels * of_pixel.factors);
  }
}

TEST(TileWork, HasAPartForTheWavesOfTheWholeGroup) {
  const std::vector<PreparedWave> waves = drawn_boxes(300);
  for (const TileShape shape : tile_shapes) {
    const TilePlan plan{shape, TileProducts::single};
    const TileShape group = group_of_tiles(shape);
    ASSERT_EQ(group.columns % shape.columns, 0);
    ASSERT_EQ(group.rows % shape.rows, 0);
    const double tiles_of_group = double(group.columns / shape.columns) * (group.rows / shape.rows);
    const double met = count_tiles(waves, shape), looks = count_tiles(waves, group) * tiles_of_group;
    const double without = work_of_tiles({}, plan, bounds).wave_tiles;  // tiles begin, too, and pixels are cleared
    EXPECT_GT(without, 0);
    // To read a wave that misses the tile takes 0.75 of the fixed work of one that meets it, as measured (tile_error.cpp).
    EXPECT_NEAR(work_of_tiles(waves, plan, bounds).wave_tiles - without, met + 0.75 * (looks - met), 1e-6 * looks);
  }
}

TEST(TileChoice, OfASmallPanelIsNotItsLargestTile) {
  // Of a tile of 128 × 120 pixels, a panel of 64 × 60 needs a quarter.
  const Grid grid{64, 60, 8_um};
  const Sources sources = test::make_random_sources(500, grid, green, 0.1_m, 0.2_m, 0.4);
  const TileChoice choice = choose_tile(prepare_waves(sources, grid), grid, green, 1e-2);
  EXPECT_TRUE(choice.meets_tolerance);
  EXPECT_LE(choice.plan.shape.columns * choice.plan.shape.rows, 64 * 60);
}

// Small tiles are summed in groups, and more waves than the cache holds (4096) in parts: every wave once in every tile.
TEST(SumTiles, OfManyWavesInSmallTilesIsTheSum) {
  const Grid grid{140, 50, 8_um};
  const PixelBox part{7, 137, 3, 48};
  const Sources sources = test::make_random_sources(9000, grid, green, 0.1_m, 0.2_m, 0.4);
  const FieldDouble exact = sum_exact(sources, grid);
  const std::vector<PreparedWave> waves = prepare_waves(sources, grid);
  for (const TileShape shape : {tile_shapes.back(), tile_shapes[6], tile_shapes[3], tile_shapes.front()}) {
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
    // Errors of the split, and rounding. A wave that is lost or counted twice in one tile changes the field by
    // √(tile / part / waves): 8e-4 for the smallest tile, 0.01 for the largest.
    const bool is_large = shape == tile_shapes.front();
    EXPECT_LT(std::sqrt(error / energy), is_large ? 1e-3 : 1e-4) << shape.columns << ' ' << shape.rows;
  }
}

}  // namespace
}  // namespace holotrace
