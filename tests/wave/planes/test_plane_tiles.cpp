#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/wave/planes/plane_plan.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/gridding_kernel.h"
#include "support/fields.h"
#include "support/wavelengths.h"

// Tiles of given plans on the processor, compared with the sum one by one: plans that the choice of the fastest would not
// reach, and every instruction set.

namespace holotrace {
namespace {

using namespace literals;
using test::make_random_sources;
using test::relative_error;

// d/r·exp(2πir/λ), one wave after the other, within their boxes.
FieldDouble sum_one_by_one(const std::vector<PreparedWave>& waves, const Grid& grid) {
  FieldDouble field(grid, green);
  for (const PreparedWave& wave : waves)
    for (int j = wave.box.y0; j < wave.box.y1; ++j)
      for (int i = wave.box.x0; i < wave.box.x1; ++i) {
        const double r = std::hypot(grid.x(i) - wave.x, grid.y(j) - wave.y, wave.depth);
        const double cycles = wave.start_cycles + (r - wave.depth) / green;
        field.samples(j, i) += std::polar(wave.amplitude * wave.depth / r, 2 * pi * (cycles - std::floor(cycles)));
      }
  return field;
}

FieldDouble sum_by_plan(const SortedWaves& waves, const PlanesTables& tables, const Grid& grid,
                        PlanesWorkspace& workspace) {
  Field field(grid, green);
  const TilePlan direct{{64, 60}, TileProducts::single};
  const int tile = tables.plan.tile;
  for (int y = 0; y < grid.ny; y += tile)
    for (int x = 0; x < grid.nx; x += tile)
      sum_planes_tile({waves, tables, direct, grid}, {x, std::min(x + tile, grid.nx), y, std::min(y + tile, grid.ny)},
                      workspace, field.samples);
  return convert<double>(field);
}

FieldDouble sum_by_plan(const std::vector<PreparedWave>& waves, const PlanesPlan& plan, const Grid& grid) {
  PlanesWorkspace workspace;
  const PlanesTables tables(plan, green, grid.pitch);
  return sum_by_plan(sort_waves(waves, plan, green, grid.pitch), tables, grid, workspace);
}

// What plane_plan.h expects of a plan: the expansion's error, that of gridding along both axes, and rounding.
double expected_error(const std::vector<PreparedWave>& waves, const PlanesPlan& plan, const Grid& grid) {
  const SplitEnergies energies =
      measure_planes(draw_pixels(waves), depths_of(waves), grid, {0, grid.nx, 0, grid.ny}, green, plan);
  return std::hypot(
      std::sqrt(energies.error / energies.waves),
      std::hypot(gridding_error_of_planes(plan, {0, grid.nx, 0, grid.ny}), rounding_error_of_planes(plan)));
}

// Corners at all pixels of a tile, one by one: no other shape within the direct sum's has less predicted work for them.
TEST(PlaneTiles, SumCornersByTheShapeOfLeastWork) {
  constexpr int tile = 120;
  const TilePlan direct{{128, 60}, TileProducts::single};
  const auto lines = [](int side) {  // those of the tiles that are lit, for all numbers of lit lines
    double sum = 0;
    for (int lit = 1; lit <= tile; ++lit) sum += (lit + side - 1) / side * side;
    return sum / tile;
  };
  const auto seconds = [&](const TilePlan& plan) {
    const double pixels = lines(plan.shape.columns) * lines(plan.shape.rows);
    return predict_seconds(pixels * tile_work(plan), summation_rates(), 1);
  };
  const TilePlan chosen = plan_of_corners(direct, tile);
  EXPECT_LE(chosen.shape.columns, 128);
  EXPECT_LE(chosen.shape.rows, 60);
  EXPECT_LT(seconds(chosen), 0.9 * seconds(direct));
  for (const TileShape& shape : tile_shapes) {
    if (shape.columns > 128 || shape.rows > 60) continue;
    // A few percent: not all sides divide the tile.
    EXPECT_LE(seconds(chosen), 1.05 * seconds({shape, direct.products})) << shape.columns << " × " << shape.rows;
  }
}

// The frequencies of waves all over the acceptance are up to 240 cells, in floats: 1.2e-5 in tiles of 240 pixels.
TEST(PlaneTiles, RoundAsTheirPlanExpects) {
  const Grid grid{480, 480, 8_um};
  // All of them light the whole panel.
  const double margin = 1.0_m * acceptance_tangent(green, grid.pitch) / (grid.nx * grid.pitch) - 1;
  const std::vector<PreparedWave> waves =
      prepare_waves(make_random_sources(60, grid, green, 1.0_m, 1.05_m, margin), grid);
  const FieldDouble exact = sum_one_by_one(waves, grid);
  for (const double oversampling : {2.0, 1.5})
    for (const int tile : {60, 120, 240}) {
      const PlanesPlan plan{tile, 8, 4, tile == 240 ? 4 : 1, true, false, oversampling};
      const double expected = expected_error(waves, plan, grid),
                   error = relative_error(sum_by_plan(waves, plan, grid), exact);
      // 60 waves of chance positions, and the draws of the expansion's error.
      EXPECT_LT(error, 1.3 * expected) << tile << " " << oversampling;
      EXPECT_GT(error, 0.3 * expected) << tile << " " << oversampling;
    }
}

// Every width and number of nodes has code of its own, and every instruction set other vectors. Boxes are cut along each axis,
// by less and by more than half of a tile, and at a corner.
TEST(PlaneTiles, AreThoseOfTheSumOneByOneOnEveryInstructionSet) {
  const Grid grid{70, 65, 8_um};
  std::vector<PreparedWave> waves = prepare_waves(make_random_sources(400, grid, green, 0.2_m, 0.202_m, 2), grid);
  waves[3].box = {0, 70, 0, 20};
  waves[8].box = {0, 70, 7, 65};
  waves[15].box = {33, 70, 0, 65};
  waves[16].box = {0, 59, 0, 65};
  waves[31].box = {21, 70, 18, 65};
  const FieldDouble exact = sum_one_by_one(waves, grid);
  for (int width = 2; width <= 8; ++width)
    for (const int nodes : {1, 2, 3, 4, 6, 8})
      for (const bool has_strips : {true, false}) {
        const double oversampling = (width + has_strips) % 2 == 0 ? 2 : 1.5;
        const PlanesPlan plan{60, width, nodes, 1, nodes % 2 == 0, has_strips, oversampling};
        const PlanesTables tables(plan, green, grid.pitch);
        const SortedWaves sorted = sort_waves(waves, plan, green, grid.pitch);
        const double expected = expected_error(waves, plan, grid);
        PlanesWorkspace workspace;
        FieldDouble best;
        for (const std::string& name : instruction_sets()) {
          const OnInstructionSet on(name);
          const FieldDouble field = sum_by_plan(sorted, tables, grid, workspace);
          EXPECT_LT(relative_error(field, exact), 1.3 * expected) << name << " " << width << " " << nodes << has_strips;
          if (best.samples.values.empty()) best = field;
          EXPECT_LT(relative_error(field, best), 2e-5) << name << " " << width << " " << nodes << has_strips;
        }
      }
}

// 120 waves, 400 times each: more than a strip's list and the list for direct sums hold. 48,000 floats are added up one after the
// other, in places; their roundings, 6e-8 of the sum so far, grow as the root of their number.
TEST(PlaneTiles, OfManyCutWavesHaveShortLists) {
  const Grid grid{60, 60, 8_um};
  std::vector<PreparedWave> once = prepare_waves(make_random_sources(120, grid, green, 0.2_m, 0.202_m, 2), grid), often;
  for (size_t i = 0; i < once.size(); ++i) once[i].box = i % 2 == 0 ? PixelBox{0, 23, 0, 60} : PixelBox{31, 60, 40, 60};
  for (int i = 0; i < 400; ++i) often.insert(often.end(), once.begin(), once.end());
  const PlanesPlan plan{60, 6, 3, 1, true, true};
  const PlanesTables tables(plan, green, grid.pitch);
  PlanesWorkspace workspace;
  const FieldDouble field = sum_by_plan(sort_waves(often, plan, green, grid.pitch), tables, grid, workspace);
  FieldDouble expected = sum_by_plan(once, plan, grid);
  for (auto& sample : expected.samples.values) sample *= 400;
  EXPECT_LT(relative_error(field, expected), 2e-5);
  for (const auto& of_axis : workspace.entries)
    for (const auto& entries : of_axis) EXPECT_LE(entries.capacity(), most_entries);
  EXPECT_GT(workspace.entries[0][0].capacity(), most_entries / 2) << "waves enough to fill it";
  EXPECT_LE(workspace.of_strip.capacity(), most_entries);
  EXPECT_LE(workspace.order.capacity(), most_entries);
  EXPECT_LE(workspace.direct.capacity(), most_entries);
  EXPECT_GT(workspace.direct.capacity(), most_entries / 2);
}

TEST(PlaneTiles, AreMultiplesOfFourPixels) { EXPECT_THROW(PlanesTables({.tile = 62}, green, 8e-6), Error); }

}  // namespace
}  // namespace holotrace
