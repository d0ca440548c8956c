#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <optional>

#include "holotrace/base/random.h"
#include "holotrace/trace/geometry/accelerator.h"
#include "holotrace/trace/geometry/uniform_grid.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/shared/sampling.h"
#include "holotrace/trace/trace.h"
#include "trace/scenes.h"

// A grid of cells finds the same hits as a search through all triangles, and as Embree.

namespace holotrace {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Intersection of a ray with the plane of a triangle: distance and barycentric coordinates, by Cramer's rule (T. Möller
// and B. Trumbore, J. Graphics Tools 2(1), 21, 1997), instead of the watertight test of the grid.
struct PlaneHit {
  double distance, b0, b1, b2;
  double inside() const { return std::min({b0, b1, b2}); }  // < 0: outside the triangle
};

PlaneHit meet_plane(const Scene& scene, const Ray& ray, uint32_t mesh, uint32_t triangle) {
  const Mesh& m = scene.meshes[mesh];
  const auto [i, j, k] = m.triangles[triangle];
  const Vec3 e1 = m.positions[j] - m.positions[i], e2 = m.positions[k] - m.positions[i];
  const Vec3 p = cross(ray.direction, e2), t = ray.origin - m.positions[i], q = cross(t, e1);
  const double determinant = dot(p, e1);
  const double b1 = dot(p, t) / determinant, b2 = dot(q, ray.direction) / determinant;
  return {dot(q, e2) / determinant, 1 - b1 - b2, b1, b2};
}

// The nearest triangle, by a search through all of them.
std::optional<GridHit> search(const Scene& scene, const Ray& ray) {
  std::optional<GridHit> nearest;
  for (uint32_t m = 0; m < scene.meshes.size(); ++m)
    for (uint32_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
      const PlaneHit met = meet_plane(scene, ray, m, t);
      if (!(met.inside() >= 0) || !(met.distance >= 0)) continue;
      if (!nearest || met.distance < nearest->distance) nearest = GridHit{met.distance, m, t, met.b1, met.b2};
    }
  return nearest;
}

Vec3 random_point(CounterRandom& random, double half) {
  const double x = random.uniform(), y = random.uniform(), z = random.uniform();
  return Vec3{2 * x - 1, 2 * y - 1, 2 * z - 1} * half;
}

// Triangles of many sizes, anywhere in a cube of side 2, 1 m behind the panel.
Scene make_soup(int count, double size) {
  Scene scene;
  scene.materials = {grey(0.5)};
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    CounterRandom random(7, 0, uint64_t(i));
    const Vec3 centre = random_point(random, 1) + Vec3{0, 0, -2};
    for (int corner = 0; corner < 3; ++corner)
      mesh.positions.push_back(centre + random_point(random, size * (1 + 9 * (i % 10 == 0))));
    const uint32_t first = uint32_t(3 * i);
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  scene.meshes = {mesh};
  return scene;
}

Ray random_ray(uint64_t seed, uint64_t i) {
  CounterRandom random(seed, 0, i);
  return {random_point(random, 1.5) + Vec3{0, 0, -2}, normalize(random_point(random, 1))};
}

TEST(UniformGrid, MeetsWhatASearchThroughAllTrianglesMeets) {
  // Distances by two formulas in double, to some 1e-16 each, except for triangles seen nearly edge on, where division
  // by a small cosine amplifies rounding: 1e-10 m is 10⁶ roundings.
  for (const double size : {0.02, 0.1, 0.6}) {
    const Scene scene = make_soup(400, size);
    const UniformGrid grid(scene);
    int hits = 0;
    for (uint64_t i = 0; i < 3000; ++i) {
      const Ray ray = random_ray(1, i);
      const auto expected = search(scene, ray);
      GridHit hit;
      const bool has_hit = grid.closest_hit(ray, infinity, hit);
      ASSERT_EQ(has_hit, expected.has_value()) << i;
      if (!has_hit) continue;
      ++hits;
      ASSERT_EQ(hit.triangle, expected->triangle) << i;
      ASSERT_NEAR(hit.distance, expected->distance, 1e-10) << i;
      ASSERT_NEAR(hit.b1, expected->b1, 1e-8) << i;
      ASSERT_NEAR(hit.b2, expected->b2, 1e-8) << i;
    }
    EXPECT_GT(hits, size > 0.05 ? 1000 : 30);
  }
}

TEST(UniformGrid, MeetsWhatEmbreeMeets) {
  // Embree in single precision may choose the other side of an edge within its rounding, some 1e-6 of a scene compared
  // with triangles of a tenth of it: 1e-4 in barycentric coordinates, more for triangles seen edge on.
  Scene scene = make_soup(3000, 0.1);
  scene.meshes.push_back(make_round_mesh({0, 0, -2}, 0.5, 40));
  const Accelerator embree(scene), grid(scene, Acceleration::grid);
  EXPECT_EQ(embree.precision().unit, grid.precision().unit);
  int compared = 0, at_edges = 0;
  for (uint64_t i = 0; i < 20000; ++i) {
    const Ray ray = random_ray(2, i);
    const auto a = embree.closest_hit(ray), b = grid.closest_hit(ray);
    const bool is_same = a.has_value() == b.has_value() &&
                         (!a || (a->point.mesh == b->point.mesh && a->point.triangle == b->point.triangle));
    if (is_same && !a) continue;
    if (is_same) {
      ++compared;
      ASSERT_NEAR(a->distance, b->distance, 1e-9) << i;  // both computed from the plane, in double
      ASSERT_EQ(a->point.is_front, b->point.is_front) << i;
      ASSERT_EQ(a->point.geometric_normal, b->point.geometric_normal) << i;
      continue;
    }
    ++at_edges;
    double nearest_edge = 1, cosine = 1;
    for (const auto& hit : {a, b})
      if (hit) {
        nearest_edge =
            std::min(nearest_edge, std::abs(meet_plane(scene, ray, hit->point.mesh, hit->point.triangle).inside()));
        cosine = std::min(cosine, std::abs(dot(hit->point.geometric_normal, ray.direction)));
      }
    EXPECT_LT(nearest_edge * cosine, 1e-4) << i;
  }
  EXPECT_GT(compared, 10000);
  EXPECT_LT(at_edges, 20);  // of 20000: a thousandth
}

TEST(UniformGrid, OcclusionIsWhetherTheNearestIsNearEnough) {
  const Scene scene = make_soup(400, 0.1);
  const UniformGrid grid(scene);
  int before = 0, beyond = 0;
  for (uint64_t i = 0; i < 3000; ++i) {
    const Ray ray = random_ray(3, i);
    GridHit hit;
    if (!grid.closest_hit(ray, infinity, hit)) {
      ASSERT_FALSE(grid.is_occluded(ray, infinity));
      continue;
    }
    ASSERT_TRUE(grid.is_occluded(ray, infinity));
    ASSERT_TRUE(grid.is_occluded(ray, hit.distance * (1 + 1e-12)));
    ASSERT_FALSE(grid.is_occluded(ray, hit.distance * (1 - 1e-12)));
    GridHit near;
    ASSERT_FALSE(grid.closest_hit(ray, hit.distance * (1 - 1e-12), near));
    hit.distance < 1 ? ++before : ++beyond;
  }
  EXPECT_GT(before, 100);
  EXPECT_GT(beyond, 100);
}

TEST(UniformGrid, NoRayLeavesAClosedMesh) {
  // Random rays, and rays to each vertex and to the middle of each edge as exactly as doubles allow.
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_round_mesh({0, 0, -2}, 0.5, 24)};
  const UniformGrid grid(scene);
  const Vec3 from{0.013, -0.021, -1.983};
  GridHit hit;
  for (uint64_t i = 0; i < 20000; ++i) {
    CounterRandom random(4, 0, i);
    ASSERT_TRUE(grid.closest_hit({from, normalize(random_point(random, 1))}, infinity, hit)) << i;
  }
  const Mesh& mesh = scene.meshes[0];
  for (const auto& triangle : mesh.triangles)
    for (size_t corner = 0; corner < 3; ++corner) {
      const Vec3 a = mesh.positions[triangle[corner]], b = mesh.positions[triangle[(corner + 1) % 3]];
      ASSERT_TRUE(grid.closest_hit({from, normalize(a - from)}, infinity, hit));
      ASSERT_TRUE(grid.closest_hit({from, normalize((a + b) / 2 - from)}, infinity, hit));
    }
}

TEST(UniformGrid, FollowsRaysAlongAxesAndInThePlanesOfCells) {
  // The planes of the grid divide the box around the triangles into equal parts.
  Scene scene = make_soup(200, 0.2);
  const UniformGrid grid(scene);
  const GridStatistics s = grid.statistics();
  Vec3 low{infinity, infinity, infinity}, high = -low;
  for (const Vec3 p : scene.meshes[0].positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  int hits = 0;
  const auto check = [&](const Ray& ray) {
    const auto expected = search(scene, ray);
    GridHit hit;
    ASSERT_EQ(grid.closest_hit(ray, infinity, hit), expected.has_value());
    if (!expected) return;
    ++hits;
    ASSERT_EQ(hit.triangle, expected->triangle);
  };
  const int columns = int(std::round(s.width / s.cell_x)), rows = int(std::round(s.height / s.cell_y));
  ASSERT_GE(columns, 4);
  for (int i = 0; i <= columns; ++i)
    for (int j = 0; j <= rows; ++j) {
      const double x = low.x + i * (high.x - low.x) / columns, y = low.y + j * (high.y - low.y) / rows;
      check({{x, y, 0}, {0, 0, -1}});  // along edges of cells, -0 and 0 in two components
      check({{x, y, -4}, {-0.0, 0, 1}});
      check({{x, -3, -2 + y}, {0, 1, 0}});
      check({{x, 3, -2 + y}, {0, -1, -0.0}});
      check({{x, y, 0}, normalize({0, 0.3, -1})});              // in a plane of cells
      check({{x, y, -2}, normalize({s.cell_x, s.cell_y, 0})});  // through corners of cells, from inside
    }
  EXPECT_GT(hits, 50);
}

TEST(UniformGrid, CountsTheCellsThatARayCrosses) {
  // A ray along x that meets nothing crosses every column of cells.
  Scene scene = make_soup(2000, 0.02);
  const UniformGrid grid(scene);
  const GridStatistics s = grid.statistics();
  EXPECT_EQ(s.triangles, 2000);
  EXPECT_GE(s.entries, s.triangles);
  // About 4 cells per triangle: 20 cells along each axis, rounded to whole numbers, differ by half a cell at most.
  EXPECT_NEAR(double(s.cells) / 2000, UniformGrid::usual_density, UniformGrid::usual_density * 3 * 0.5 / 20);
  const double columns = std::round(s.width / s.cell_x);
  int misses = 0;
  for (uint64_t i = 0; i < 200; ++i) {
    CounterRandom random(5, 0, i);
    const double y = 1.6 * random.uniform() - 0.8, z = 1.6 * random.uniform() - 0.8;
    GridCounts counts;
    GridHit hit;
    if (grid.closest_hit({{-9, y, -2 + z}, {1, 0, 0}}, infinity, hit, &counts)) continue;
    ++misses;
    ASSERT_EQ(double(counts.cells), columns);
    ASSERT_EQ(counts.rays, 1);
  }
  EXPECT_GT(misses, 50);
  GridCounts counts;
  GridHit hit;
  EXPECT_FALSE(grid.closest_hit({{-9, 0, 9}, {1, 0, 0}}, infinity, hit, &counts));
  EXPECT_EQ(counts.cells, 0);  // outside the box
}

TEST(UniformGrid, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene = make_soup(5000, 0.05);
  const auto cost = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] {
      const UniformGrid grid(scene);
      GridCounts counts;
      for (uint64_t i = 0; i < 2000; ++i) grid.is_occluded(random_ray(6, i), infinity, &counts);
      return std::pair(counts.cells, counts.tests);
    });
  };
  EXPECT_EQ(cost(1), cost(4));
}

TEST(UniformGrid, FlatAndEmptyScenesAreScenes) {
  Scene scene;
  scene.materials = {grey(0.5)};
  EXPECT_FALSE(UniformGrid(scene).is_occluded({{}, {0, 0, -1}}, infinity));
  scene.meshes = {make_wall(-0.3, 10_mm, 5_mm)};  // no extent in z
  const UniformGrid grid(scene);
  GridHit hit;
  ASSERT_TRUE(grid.closest_hit({{1_mm, 2_mm, 0}, {0, 0, -1}}, infinity, hit));
  EXPECT_NEAR(hit.distance, 0.3, 1e-16);
  EXPECT_TRUE(grid.is_occluded({{1_mm, 2_mm, -0.5}, {0, 0, 1}}, infinity)) << "both sides count";
  EXPECT_FALSE(grid.is_occluded({{11_mm, 2_mm, 0}, {0, 0, -1}}, infinity));
  EXPECT_EQ(error_of([&] { UniformGrid(scene, 0); }), "expected a density above 0 cells per triangle, got 0");
}

TEST(UniformGrid, TracesAndRendersTheSameLightAsEmbree) {
  // The same random numbers on the same hits except for rounding; one path in thousands changes at an edge.
  const Scene scene = make_corner();
  const Grid panel{64, 64, 8e-6};
  TraceParams params;
  params.columns = params.rows = 24;
  params.field_of_view = 0.03;
  params.paths = 8;
  const auto power = [](const Sources& sources) {
    double sum = 0;
    for (const Source& wave : sources.waves) sum += double(wave.amplitude) * wave.amplitude;
    return sum;
  };
  const Sources embree = trace(scene, panel, green_light, params);
  params.accelerator = Acceleration::grid;
  const Sources grid = trace(scene, panel, green_light, params);
  ASSERT_EQ(embree.waves.size(), grid.waves.size());
  ASSERT_GT(grid.waves.size(), 100U);
  for (size_t i = 0; i < grid.waves.size(); ++i)
    ASSERT_NEAR(length(embree.waves[i].origin - grid.waves[i].origin), 0, 1e-12);
  EXPECT_NEAR(power(grid) / power(embree), 1, 1e-3);

  RenderParams look;
  look.rows = 24;
  look.paths = 8;
  look.field_of_view = 0.03;
  const auto mean = [](const Image& image) {
    double sum = 0;
    for (const float value : image.values) sum += value;
    return sum;
  };
  const double bright = mean(render(scene, panel, green_light, look));
  look.accelerator = Acceleration::grid;
  EXPECT_NEAR(mean(render(scene, panel, green_light, look)) / bright, 1, 1e-3);
}

}  // namespace
}  // namespace holotrace
