#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "holotrace/data/shapes.h"
#include "holotrace/estimate/cost.h"

namespace holotrace {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

GridCost count(const UniformGrid& grid) {
  GridCounts counts;
  GridHit hit;
  for (const Ray& ray : cloud_rays(20000)) grid.closest_hit(ray, infinity, hit, &counts);
  return counted_grid_cost(counts, {});
}

TEST(GridCost, OfEvenlySpreadTrianglesIsPredicted) {
  // All chords are assumed to have the mean length, and fewer triangles are near the faces of the box: 15 %, less than
  // half of the factor of 2.15 from one of these to the next. Standard errors of 20000 rays are below 1 %.
  for (const int triangles : {1000, 10000, 100000}) {
    const UniformGrid grid(make_triangle_cloud(triangles));
    const GridCost predicted = predict_grid_cost(grid.statistics(), {}), counted = count(grid);
    EXPECT_NEAR(predicted.cells / counted.cells, 1.1, 0.1) << triangles;
    EXPECT_NEAR(predicted.tests / counted.tests, 1.15, 0.15) << triangles;
  }
}

TEST(GridCost, GrowsAsTheCubeRootOfTheTriangles) {
  const double few = count(UniformGrid(make_triangle_cloud(1000))).cells;
  const double many = count(UniformGrid(make_triangle_cloud(64000))).cells;
  EXPECT_NEAR(many / few, 4, 0.3);  // 64^(1/3), minus the one cell in which every ray begins
}

TEST(GridCost, OfASurfaceIsPredictedToAFactorOfTwo) {
  Scene scene;
  scene.materials.emplace_back();
  scene.meshes = {make_sphere(1, 60)};
  transform_mesh({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -2}}, scene.meshes[0]);
  const UniformGrid grid(scene);
  const GridCost predicted = predict_grid_cost(grid.statistics(), {}), counted = count(grid);
  EXPECT_LT(std::abs(std::log2(predicted.cells / counted.cells)), 1);
  EXPECT_LT(std::abs(std::log2(predicted.tests / counted.tests)), 1);
}

TEST(GridCost, WithoutHitsIsTheMeanChord) {
  // Triangles of almost no area: cells = 1 + (4V/S)/2·Σ1/s, for a cube of n³ cells 1 + (2/3)/2·3n = 1 + n.
  const GridStatistics empty{.triangles = 1,
                             .cells = 1000,
                             .entries = 10,
                             .cell_x = 0.1,
                             .cell_y = 0.1,
                             .cell_z = 0.1,
                             .width = 1,
                             .height = 1,
                             .depth = 1,
                             .area = 0};
  const GridCost cost = predict_grid_cost(empty, {.cell = 2, .test = 3, .ray = 5});
  EXPECT_NEAR(cost.cells, 11, 1e-12);
  EXPECT_NEAR(cost.tests, 0.11, 1e-12);
  EXPECT_NEAR(cost.seconds, 5 + 2 * 11 + 3 * 0.11, 1e-12);
}

TEST(GridCost, RaysOfACloudAreUniformIsotropicLines) {
  // Mean chord of a cube of side 1 for uniform isotropic lines: 4V/S = 2/3; standard deviation below 0.5.
  const auto rays = cloud_rays(20000);
  double sum = 0;
  for (const Ray& ray : rays) {
    const Vec3 o = ray.origin - Vec3{0, 0, -2}, d = ray.direction;
    ASSERT_NEAR(length(d), 1, 1e-12);
    double enter = -infinity, leave = infinity;
    for (const auto& [p, q] : {std::pair{o.x, d.x}, {o.y, d.y}, {o.z, d.z}}) {
      enter = std::max(enter, std::min((-0.5 - p) / q, (0.5 - p) / q));
      leave = std::min(leave, std::max((-0.5 - p) / q, (0.5 - p) / q));
    }
    ASSERT_GT(enter, 0) << "from outside";
    sum += leave - enter;
  }
  EXPECT_NEAR(sum / 20000, 2.0 / 3, 4 * 0.5 / std::sqrt(20000.0));
}

TEST(GridCost, CalibratesOnThisMachine) {
  const GridRates rates = calibrate_grid();
  EXPECT_GT(rates.cell + rates.test + rates.ray, 0);
  EXPECT_GE(std::min({rates.cell, rates.test, rates.ray}), 0);
}

}  // namespace
}  // namespace holotrace
