#include <gtest/gtest.h>

#include "holotrace/base/random.h"
#include "holotrace/trace/lights/emitters.h"
#include "trace/follow.h"

// Path expressions on light paths: the light of each path group.

namespace holotrace {
namespace {

/// A room with all kinds of things: diffuse, glossy and mirror surfaces, lamps of every kind and a sky.
Scene rich_scene() {
  Scene scene;
  scene.materials = {grey(0.6),
                     {ConductorMaterial{metal_index("Ag"), 0}},
                     MetallicRoughnessMaterial{.base_color = {0.7, 0.4, 0.2}, .metallic = 0.3, .roughness = 0.5},
                     grey(0.1, 4),
                     {ConductorMaterial{metal_index("Cu"), 0.4}}};
  scene.meshes = {make_wall(-0.32, 20_mm, 20_mm), make_test_quad({-20_mm, 0, -0.3}, {0, 20_mm, 0}, {0, 0, 20_mm}, 1),
                  make_test_quad({0, -10_mm, -0.3}, {0, 0, 20_mm}, {20_mm, 0, 0}, 2),
                  make_test_quad({5_mm, 8_mm, -0.3}, {0, 0, 4_mm}, {4_mm, 0, 0}, 3),
                  make_round_mesh({2_mm, -4_mm, -0.305}, 4_mm, 16)};
  scene.meshes[4].material = 4;
  scene.lights = {PointLight{{0, 15_mm, -0.28}, {1e-3, 2e-3, 1e-3}},
                  RectangleLight{{10_mm, 10_mm, -0.29}, {0, 0, -10_mm}, {5_mm, -5_mm, 0}, {3, 2, 1}},
                  SpotLight{{0, 5_mm, -0.27}, {0, 0, -1}, {2e-3, 1e-3, 1e-3}, 0.1, 0.4},
                  DirectionalLight{normalize({-1, -1, -1}), {0.5, 0.5, 0.4}}};
  auto map = std::make_shared<Image>(8, 16, 3);
  CounterRandom random(2, 0, 0);
  for (float& value : map->values) value = float(random.uniform());
  scene.environment = {map, {1, 1, 1}, 0.3};
  scene.background = {0.1, 0.1, 0.1};
  return scene;
}

const std::vector<Ray> rich_rays = {{{1_mm, 2_mm, 0}, {0, 0, -1}},                         // the wall
                                    {{0, 0, -0.29}, normalize({-1, 0.1, -0.2})},           // the mirror
                                    {{0, 5_mm, -0.28}, normalize({-0.2, -1, -0.2})},       // the glossy floor
                                    {{2_mm, -4_mm, -0.28}, normalize({0.05, 0.05, -1})}};  // the copper ball

TEST(PathGroups, OfAPartitionAddUpToTheWhole) {
  const std::vector<std::string> parts = {"EL", "E(D|G)L", "ESL", "ED.+L", "EG.+L", "ES(D|G)L", "ESS.*L", "ES(D|G).+L"};
  for (const Ray& ray : rich_rays) {
    const double whole = sums_of(rich_scene(), ray, {}, {}, 2000)[0];
    double sum = 0;
    for (const double part : sums_of(rich_scene(), ray, parts, {}, 2000)) sum += part;
    EXPECT_GT(whole, 0.01);
    EXPECT_NEAR(sum / whole, 1, 1e-6);
  }
}

TEST(PathGroups, OfSeparateLightsAddUpToTheWhole) {
  for (const Ray& ray : rich_rays) {
    const double whole = sums_of(rich_scene(), ray, {}, {}, 2000)[0];
    const std::vector<double> lights = sums_of(rich_scene(), ray, {}, {.separate_lights = true}, 2000);
    ASSERT_EQ(lights.size(), 6U) << "four lights, emission, background";
    double sum = 0;
    for (const double light : lights) sum += light;
    EXPECT_NEAR(sum / whole, 1, 1e-12);
    // And each sum equals that of the scene with this light alone.
    Scene alone = rich_scene();
    alone.lights = {alone.lights[2]};
    alone.environment.reset();
    alone.background = {};
    for (Material& material : alone.materials) material.emission = {};
    const double spot = sums_of(alone, ray, {}, {}, 20000)[0];
    const double spread = std::abs(spot - lights[2]);
    EXPECT_LE(spread, 0.2 * spot + 1e-9) << "2000 paths, of which a tenth see more than one bounce";
  }
}

TEST(PathGroups, RayCastingIsTheDirectLightAlone) {
  Scene scene = rich_scene();
  scene.lights = {scene.lights[0]};
  scene.environment.reset();
  scene.background = {};
  scene.materials[3].emission = {};
  const Ray& ray = rich_rays[0];
  // One point light: the direct light has no randomness, and one surface gives no other light.
  const double direct = sums_of(scene, ray, {}, {.max_depth = 1}, 1)[0];
  EXPECT_GT(direct, 0);
  EXPECT_NEAR(sums_of(scene, ray, {"E(D|G)L"}, {}, 100)[0], direct, 1e-12 * direct);
  EXPECT_GT(sums_of(scene, ray, {"E.*L"}, {}, 100)[0], 1.001 * direct);
}

TEST(PathGroups, RadiosityIsAllOfADiffuseSceneAndNothingOfAMirror) {
  Scene room = make_box_scene({0, 0, -0.3}, {10_mm, 8_mm, 6_mm}, grey(0.5, 1));
  const Ray ray{{1_mm, 1_mm, -0.3}, normalize({0.3, -0.5, 0.2})};
  EXPECT_NEAR(sums_of(room, ray, {"ED*L"}, {}, 500)[0], sums_of(room, ray, {}, {}, 500)[0], 1e-12);
  EXPECT_EQ(sums_of(rich_scene(), rich_rays[1], {"ED*L"}, {}, 500)[0], 0) << "the mirror is the first surface";
}

TEST(PathGroups, RecursiveRayTracingSeesTheWallInTheMirrorByItsReflectance) {
  // The mirror is at 45° on the axis. The wall that it shows is 30 mm to the left, lit from 20 mm in front of it.
  Scene scene;
  scene.materials = {grey(0.6), {ConductorMaterial{constant_index(3), 0}}};
  scene.meshes = {make_test_quad({0, 0, -0.3}, normalize({1, 0, 1}) * 10_mm, {0, 10_mm, 0}, 1),
                  make_test_quad({-30_mm, 0, -0.3}, {0, 0, 10_mm}, {0, 10_mm, 0})};
  scene.lights = {PointLight{{-10_mm, 0, -0.28}, {1, 1, 1}}};
  const Ray ray{{0, 0, 0}, {0, 0, -1}};
  const double wall = 0.6 / pi * (20 / std::sqrt(800.0)) / 800e-6;
  // Fresnel at 45°, n = 3: the mean over s and p.
  const double c = std::sqrt(0.5), t = std::sqrt(1 - 0.5 / 9);
  const double s = std::pow((c - 3 * t) / (c + 3 * t), 2), p = std::pow((3 * c - t) / (3 * c + t), 2);
  const double reflectance = (s + p) / 2, expected = reflectance * wall;
  constexpr int paths = 40000;
  // One path in 1/R sees the wall.
  const double error = 4 * wall * std::sqrt(reflectance * (1 - reflectance) / paths);
  EXPECT_NEAR(sums_of(scene, ray, {"ES*(D|G)L"}, {}, paths)[0], expected, error);
  EXPECT_EQ(sums_of(scene, ray, {"ED*L"}, {}, 1000)[0], 0);
  EXPECT_EQ(sums_of(scene, ray, {"ESSDL"}, {}, 1000)[0], 0);
}

TEST(PathGroups, PathsThatNoGroupTakesEndAtOnce) {
  const Scene room = make_box_scene({0, 0, -0.3}, {10_mm, 8_mm, 6_mm}, grey(0.9, 1));
  const PathScene scene(room, Lines{}, {"EDL"}, {});
  const PathStart start = start_of(scene, {{0, 0, -0.3}, {0, 0, -1}});
  Vec3 sum;
  PathCounts counts;
  mean_radiance(scene, start, 1000, 0, {&sum, 1}, counts);
  EXPECT_EQ(counts.vertices, counts.paths + counts.rays) << "two surfaces at most";
  EXPECT_EQ(counts.left_out + counts.absorbed, counts.paths);
  EXPECT_NEAR(sum.y, 0.9, 0.01) << "EDL of a furnace is ρ; no way varies more than by its weight";
}

}  // namespace
}  // namespace holotrace
