// The light that many paths sample at their common start, against the same paths one by one.

#include <gtest/gtest.h>

#include <numeric>

#include "holotrace/base/random.h"
#include "trace/follow.h"

namespace holotrace {
namespace {

// A wall with a shelf before it, a plate on the far side of the light, and lamps of each kind.
Scene make_room(const Material& wall, bool is_visible) {
  Scene scene;
  scene.materials = {wall, grey(0.5), grey(0.2, 3)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm), make_test_quad({3_mm, 1_mm, -0.295}, {2_mm, 0, 0}, {0, 1_mm, 1_mm}, 1),
                  make_test_quad({-9_mm, 4_mm, -0.29}, {0, 1_mm, 0}, {0, 0, -2_mm}, 2)};
  scene.lights = {RectangleLight{{-4_mm, 2_mm, -0.288}, {0, 5_mm, 1_mm}, {7_mm, 0, 0}, {5, 4, 3}, is_visible},
                  PointLight{{8_mm, 9_mm, -0.28}, {1e-4, 2e-4, 3e-4}},
                  RectangleLight{{6_mm, -9_mm, -0.31}, {0, 6_mm, 0}, {0, 0, 20_mm}, {2, 2, 2}, is_visible},
                  SpotLight{{0, 0, -0.25}, {0, 0, -1}, {2e-4, 2e-4, 2e-4}, 0.05, 0.2}};
  return scene;
}

// 40 paths: two whole blocks of 16, and a part of one. Single sums differ by their order, and 1e-12 by the lanes'
// rounding; a shadow ray that met another surface would change them by 1e-3.
void expect_sum_of_paths(const Scene& scene, const PathParams& params, const std::vector<std::string>& groups = {}) {
  constexpr int paths = 40, places = 60;
  const PathScene path_scene(scene, Lines{}, groups, params);
  CounterRandom random(7, 0, 0);
  double brightest = 0;
  for (int place = 0; place < places; ++place) {
    const double x = 16_mm * (random.uniform() - 0.5), y = 16_mm * (random.uniform() - 0.5);
    const PathStart start = start_of(path_scene, {{x, y, -0.2}, {0, 0, -1}});
    std::vector<Vec3> together(size_t(path_scene.sums())), sums(together.size());
    PathCounts counts, single;
    mean_radiance(path_scene, start, paths, uint64_t(place), together, counts);
    LowDiscrepancy numbers(params.seed, 0, uint64_t(place));
    for (int path = 0; path < paths; ++path) {
      numbers.start(uint32_t(path));
      add_radiance(path_scene, start, numbers, sums, single);
    }
    for (size_t i = 0; i < sums.size(); ++i) {
      const Vec3 mean = sums[i] / paths;
      const double tolerance = 1e-11 * (mean.x + mean.y + mean.z);
      EXPECT_NEAR(together[i].x, mean.x, tolerance) << "sum " << i << " at " << x << ", " << y;
      EXPECT_NEAR(together[i].y, mean.y, tolerance);
      EXPECT_NEAR(together[i].z, mean.z, tolerance);
      brightest = std::max(brightest, mean.x);
    }
    EXPECT_EQ(counts.paths, single.paths);
    EXPECT_EQ(counts.rays, single.rays);
    EXPECT_EQ(counts.vertices, single.vertices);
    EXPECT_LE(counts.shadow_rays, single.shadow_rays);
  }
  EXPECT_GT(brightest, 0);
}

Environment make_environment() {
  auto map = std::make_shared<Image>(4, 8, 3);
  for (size_t i = 0; i < map->values.size(); ++i) map->values[i] = float(i % 7);
  return {map, {1, 1, 1}, 0.3};
}

TEST(DirectLight, OfManyPathsIsTheirSumForADiffuseSurface) {
  for (const bool is_visible : {true, false}) expect_sum_of_paths(make_room(grey(0.6), is_visible), {.max_depth = 4});
}

TEST(DirectLight, OfManyPathsIsTheirSumForOtherSurfaces) {
  const Material translucent{DiffuseMaterial{.reflectance = {0.3, 0.4, 0.5}, .transmittance = Vec3{0.4, 0.3, 0.2}}};
  const Material lacquer{MetallicRoughnessMaterial{.base_color = {0.8, 0.5, 0.2}, .metallic = 0.3, .roughness = 0.4}};
  for (const Material& material : {translucent, lacquer})
    expect_sum_of_paths(make_room(material, true), {.max_depth = 4});
}

TEST(DirectLight, OfManyPathsIsTheirSumForEachPathGroupAndLight) {
  const Material lacquer{MetallicRoughnessMaterial{.base_color = {0.8, 0.5, 0.2}, .metallic = 0.3, .roughness = 0.4}};
  const std::vector<std::string> groups{"E(D|G)L", "EDDL", "EG.*L"};
  expect_sum_of_paths(make_room(lacquer, true), {.max_depth = 4, .separate_lights = true}, groups);
  expect_sum_of_paths(make_room(grey(0.6), true), {.max_depth = 4, .separate_lights = true}, groups);
}

TEST(DirectLight, OfManyPathsIsTheirSumUnderAnEnvironment) {
  Scene scene = make_room(grey(0.6), true);
  scene.environment = make_environment();
  expect_sum_of_paths(scene, {.max_depth = 3});
}

TEST(DirectLight, OfManyPathsIsTheirSumBehindAPane) {
  Scene scene = make_room(grey(0.6), true);
  scene.materials.push_back({DielectricMaterial{.is_thin = true}});
  scene.meshes.push_back(make_test_quad({0, 0, -0.285}, {10_mm, 0, 0}, {0, 10_mm, 0}, 3));
  expect_sum_of_paths(scene, {.max_depth = 5});
}

// Paths of a camera, which are followed together, against the same paths one by one. The room has a mirror, and a lamp in the
// picture; some rays pass it. In the second case there are also a mesh that emits, a background and an environment. Thirteen paths,
// so that lanes are empty.
TEST(DirectLight, OfACamerasPathsIsThatOfThePathsOneByOne) {
  for (const int roulette_depth : {1, 4})
    for (const bool is_lit_beyond : {false, true}) {
      Scene scene = make_room(grey(0.6), true);
      scene.materials[0].two_sided = false;
      scene.materials.push_back({ConductorMaterial{}});
      std::get<ConductorMaterial>(scene.materials[3].surface).roughness = 0;
      scene.meshes.push_back(make_test_quad({-5_mm, -5_mm, -0.295}, {3_mm, 0, 1_mm}, {0, 3_mm, 0}, 3));
      if (is_lit_beyond) {
        scene.background = {0.1, 0.2, 0.3};
        scene.environment = make_environment();
        scene.materials.push_back(grey(0.3, 2));
        scene.meshes.push_back(make_test_quad({6_mm, 3_mm, -0.298}, {1_mm, 0, 1_mm}, {0, 2_mm, 0}, 4));
      }
      const PathScene path_scene(scene, Lines{}, {"E.*L", "EDDL"},
                                 {.max_depth = 5, .roulette_depth = roulette_depth, .separate_lights = true});
      CounterRandom random(9, 0, 0);
      PathCounts counts, single;
      uint32_t missed = 0;
      double brightest = 0;
      for (uint64_t pixel = 0; pixel < 200; ++pixel) {
        std::vector<NumberedRay> rays;
        for (uint32_t path = 2; path < 15; ++path) {
          const double x = 24_mm * (random.uniform() - 0.5), y = 24_mm * (random.uniform() - 0.5);
          rays.push_back({{{0, 0, -0.1}, normalize({x, y, -0.2})}, path});
        }
        std::vector<Vec3> lights(rays.size()), sums(size_t(path_scene.sums()));
        LowDiscrepancy numbers(1, 0, pixel), same(1, 0, pixel);
        numbers.start(16);
        same.start(16);
        const uint32_t misses = find_radiance(path_scene, rays, 1, numbers, lights, counts);
        for (size_t i = 0; i < rays.size(); ++i) {
          same.start(16 + rays[i].path);
          same.skip(1);
          std::fill(sums.begin(), sums.end(), Vec3{});
          EXPECT_EQ(!add_radiance(path_scene, rays[i].ray, same, sums, single), bool(misses >> i & 1));
          // What is beyond has the weight 1 in a scene without media.
          const bool is_miss = misses >> i & 1;
          const Vec3 light = is_miss ? Vec3{1, 1, 1} : std::accumulate(sums.begin(), sums.end(), Vec3{});
          const double tolerance = 1e-11 * (light.x + light.y + light.z);  // as above
          EXPECT_LE(length(lights[i] - light), tolerance) << "ray " << i << ", pixel " << pixel;
          brightest = std::max(brightest, light.x);
        }
        EXPECT_EQ(misses >> rays.size(), 0U);
        missed += misses != 0;
      }
      EXPECT_GT(brightest, 0);
      EXPECT_GT(missed, 0U);
      EXPECT_EQ(counts.paths, single.paths);
      EXPECT_EQ(counts.rays, single.rays);
      EXPECT_EQ(counts.vertices, single.vertices);
      // Rounding decides whether a place on the emitting mesh lies in its plane; light from there is 1e-16 of what arrives.
      EXPECT_NEAR(double(counts.shadow_rays), double(single.shadow_rays), is_lit_beyond ? 10 : 0);
      EXPECT_EQ(counts.absorbed, single.absorbed);
      EXPECT_EQ(counts.escaped, single.escaped);
      EXPECT_EQ(counts.cut, single.cut);
      EXPECT_EQ(counts.left_out, single.left_out);
    }
}

// A point light lies in one direction: one shadow ray tells for all paths.
TEST(DirectLight, OfAPointLightTakesOneShadowRay) {
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.lights = {PointLight{{30_mm, 0, -0.26}, {1, 2, 3}}};
  const PathScene path_scene(scene, Lines{}, {}, {.max_depth = 1});
  PathCounts counts;
  Vec3 sum;
  mean_radiance(path_scene, start_of(path_scene, {{}, {0, 0, -1}}), 64, 0, {&sum, 1}, counts);
  EXPECT_EQ(counts.shadow_rays, 1);
  EXPECT_NEAR(sum.y, 0.6 / pi * 2 * 0.8 / (0.05 * 0.05), 1e-9);  // d = 50 mm, cosθ = 40/50
}

}  // namespace
}  // namespace holotrace
