#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

#include "holotrace/base/random.h"
#include "holotrace/trace/lights/emitters.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/materials/fresnel.h"
#include "support/statistics.h"
#include "trace/lights/wall_scene.h"

namespace holotrace {
namespace {

TEST(Light, SpotFallsSmoothlyFromItsInnerToItsOuterAngle) {
  // 40 mm in front of the wall and 30 mm off the axis: d = 50 mm, cosθ = 4/5 at the wall and off the spot's axis, which
  // is the normal.
  const double full = 0.6 / pi * 0.8 / (0.05 * 0.05);
  const auto radiance = [&](double inner_cosine, double outer_cosine) {
    Scene scene = wall_scene();
    scene.lights = {
        SpotLight{{30_mm, 0, -0.26}, {0, 0, -1}, {1, 1, 1}, std::acos(inner_cosine), std::acos(outer_cosine)}};
    return follow(scene, onto_the_wall, 1, 1).mean();
  };
  // No randomness: only rounding of cosines and of single factors.
  EXPECT_NEAR(radiance(0.7, 0.5), full, 1e-12 * full) << "inside the inner cone";
  EXPECT_EQ(radiance(0.95, 0.9), 0) << "outside the outer one";
  EXPECT_NEAR(radiance(0.9, 0.6), full * 20 / 27, 1e-12 * full) << "x = 2/3: x²(3 − 2x)";
  EXPECT_NEAR(radiance(0.79, 0.79), full, 1e-12 * full) << "a hard edge";
  EXPECT_EQ(radiance(0.81, 0.81), 0);
}

TEST(Light, ParallelLightGivesItsIrradianceTimesTheCosine) {
  Scene scene = wall_scene();
  scene.lights = {DirectionalLight{{0.6, 0, -0.8}, {1, 7, 1}}};
  const double expected = 0.6 / pi * 7 * 0.8;
  EXPECT_NEAR(follow(scene, onto_the_wall, 1, 1).mean(), expected, 1e-12 * expected);
  scene.lights = {DirectionalLight{{0.6, 0, 0.8}, {1, 7, 1}}};
  EXPECT_EQ(follow(scene, onto_the_wall, 1, 1).mean(), 0) << "from behind the wall";
  scene.lights = {DirectionalLight{{0.6, 0, -0.8}, {1, 7, 1}}};
  scene.meshes.push_back(make_test_quad({-60_mm, 0, -0.22}, {5_mm, 0, 0}, {0, 5_mm, 0}));
  EXPECT_EQ(follow(scene, onto_the_wall, 1, 1).mean(), 0) << "100 mm up the beam something stands in it";
}

TEST(Light, ABeamLightsWhatIsWithinItsRadius) {
  Scene scene = wall_scene();
  // The axis meets the wall at x = 5 mm with cosine 4/5: the centre is 5 mm · 4/5 = 4 mm off the axis.
  scene.lights = {
      DirectionalLight{{0.6, 0, -0.8}, {1, 1, 1}, Vec3{5_mm, 0, -0.3} - Vec3{0.6, 0, -0.8} * 0.1, 4.001_mm}};
  EXPECT_GT(follow(scene, onto_the_wall, 1, 1).mean(), 0);
  std::get<DirectionalLight>(scene.lights[0]).radius = 3.999_mm;
  EXPECT_EQ(follow(scene, onto_the_wall, 1, 1).mean(), 0);
}

/// Transmittance of a pane of index 1.5 at a cosine of 0.8, with the reflections between its faces.
double share_through_pane() {
  const double reflected = reflectance_dielectric(0.8, 1.5);
  return 1 - 2 * reflected / (1 + reflected);
}

/// A wall on which a ray along the axis finds the light of a lamp at (30, 0, −260) mm, 50 mm away, at a cosine of
/// 0.8. Panes stand between lamp and wall, not in the way of the ray.
Scene make_wall_behind_panes(const Light& lamp, int panes, const Material& glass) {
  Scene scene;
  scene.materials = {grey(0.6), glass};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  for (int i = 0; i < panes; ++i) {
    const double part = 0.4 + 0.1 * i;
    scene.meshes.push_back(make_test_quad({part * 30_mm, 0, -0.3 + part * 40_mm}, {2_mm, 0, 0}, {0, 2_mm, 0}, 1));
  }
  scene.lights = {lamp};
  return scene;
}

TEST(Light, PanesLetLightStraightThrough) {
  const Ray ray{{}, {0, 0, -1}};
  const Vec3 lamp{30_mm, 0, -0.26}, down = normalize(Vec3{0, 0, -0.3} - lamp), one{1, 1, 1};
  const Material pane = DielectricMaterial{.is_thin = true};
  for (const Light& light :
       {Light{PointLight{lamp, one}}, Light{PointLight{lamp, one, true}}, Light{SpotLight{lamp, down, one, 0.1, 0.2}},
        Light{DirectionalLight{down, one}}, Light{DirectionalLight{down, one, lamp, 5_mm, true}}}) {
    const auto sums = [&](int panes, int max_depth) {
      return sums_of(make_wall_behind_panes(light, panes, pane), ray, {"EDL", "EDSL", "EDSSL"},
                     {.max_depth = max_depth}, 1);
    };
    const double direct = sums(0, 1)[0], share = share_through_pane();
    EXPECT_GT(direct, 0);
    // No randomness: only rounding.
    const auto one_pane = sums(1, 2), two_panes = sums(2, 3);
    EXPECT_EQ(one_pane[0], 0);
    EXPECT_NEAR(one_pane[1] / direct, share, 1e-9);
    EXPECT_EQ(two_panes[1], 0);
    EXPECT_NEAR(two_panes[2] / direct, share * share, 1e-9);
    EXPECT_EQ(sums(1, 1)[1], 0) << "a pane is a surface of the path";
    // A wall in the way blocks light, behind a pane too; so does solid glass.
    Scene closed = make_wall_behind_panes(light, 2, pane);
    closed.meshes[2].material = 0;
    EXPECT_EQ(follow(closed, ray, 1, 1).mean(), 0);
    EXPECT_EQ(follow(make_wall_behind_panes(light, 1, DielectricMaterial{}), ray, 1, 1).mean(), 0);
  }
}

// The card stands 10 mm behind the lamp, and the pane 20 mm before the wall: nearer to each other than lamp and wall.
TEST(Light, WhatStandsBehindALampCastsNoShadowThroughAPane) {
  const Vec3 lamp{30_mm, 0, -0.26};
  Scene scene = make_wall_behind_panes(PointLight{lamp, {1, 1, 1}}, 1, DielectricMaterial{.is_thin = true});
  const Ray ray{{}, {0, 0, -1}};
  const double without = follow(scene, ray, 1, 2).mean();
  EXPECT_GT(without, 0);
  scene.meshes.push_back(make_test_quad(lamp + Vec3{6_mm, 0, 8_mm}, {2_mm, 0, 0}, {0, 2_mm, 0}));
  EXPECT_EQ(follow(scene, ray, 1, 2).mean(), without);
}

TEST(Light, WhatPathsMeetBehindAPaneIsNotCountedTwice) {
  const RectangleLight lamp{{40_mm, -10_mm, -0.26}, {-20_mm, 0, 0}, {0, 20_mm, 0}, {1, 1, 1}};
  const Material pane = DielectricMaterial{.is_thin = true};
  Scene scene = make_wall_behind_panes(lamp, 0, pane);
  const Ray ray{{}, {0, 0, -1}};
  const double direct = follow(scene, ray, 40000, 2).mean();
  scene.meshes.push_back(make_test_quad({25_mm, 0, -0.27}, {20_mm, 0, 0}, {0, 20_mm, 0}, 1));
  const Statistics through = follow(scene, ray, 200000, 2);
  EXPECT_LT(through.standard_error(), 0.02 * direct);
  EXPECT_NEAR(through.mean() / direct, share_through_pane(), 0.08);
}

TEST(Light, OneSidedEmissionShinesFromTheFrontOnly) {
  Scene scene = wall_scene();
  scene.materials.push_back(grey(0, 5));
  scene.materials[1].two_sided = false;
  const double expected = 0.6 * 5 * 4 * corner_view_factor(20_mm, 20_mm, 30_mm);
  scene.meshes.push_back(make_test_quad({0, 0, -0.27}, {0, 20_mm, 0}, {20_mm, 0, 0}, 1));  // its front faces −z
  const Ray ray{{0, 0, -0.28}, {0, 0, -1}};
  const Statistics front = follow(scene, ray, 20000, 2);
  EXPECT_NEAR(front.mean(), expected, 4 * front.standard_error());
  EXPECT_LT(front.standard_error(), 0.005 * expected) << "the lamp is asked, not only met";
  EXPECT_EQ(follow(scene, {{0, 0, 0}, {0, 0, -1}}, 10, 1).mean(), 0) << "seen from its back";
  scene.meshes[1] = make_test_quad({0, 0, -0.27}, {20_mm, 0, 0}, {0, 20_mm, 0}, 1);
  EXPECT_EQ(follow(scene, ray, 1000, 2).mean(), 0);
}

TEST(Light, AnEmissionTextureGivesTheIntegralOverItsPattern) {
  auto texture = std::make_shared<Image>(8, 8, 3);
  CounterRandom random(1, 0, 0);
  for (float& value : texture->values) value = float(random.uniform() * random.uniform());
  Scene scene = wall_scene();
  scene.materials.push_back(grey(0, 5));
  scene.materials[1].emission_texture = texture;
  scene.meshes.push_back(make_test_quad({5_mm, 0, -0.28}, {20_mm, 0, 0}, {0, 20_mm, 0}, 1));
  // ρ/π ∫ L cosθ cosθ'/d² dA by midpoints; 400 per side resolve pixels of 5 mm to 1e-4.
  double integral = 0;
  constexpr int side = 400;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const double u = (i + 0.5) / side, v = (j + 0.5) / side;
      const double x = 5_mm + (2 * u - 1) * 20_mm, y = (2 * v - 1) * 20_mm, z = 20_mm, squared = x * x + y * y + z * z;
      integral += eval_texture(*texture, {u, v}).y * z * z / (squared * squared) * (40_mm * 40_mm / (side * side));
    }
  const double expected = 0.6 / pi * 5 * integral;
  const Statistics found = follow(scene, {{0, 0, -0.29}, {0, 0, -1}}, 40000, 2);
  EXPECT_NEAR(found.mean(), expected, 4 * found.standard_error() + 1e-4 * expected);
  EXPECT_LT(found.standard_error(), 0.01 * expected);
}

TEST(Light, ALampOfManyTrianglesIsItsRectangle) {
  // 2 · 20² triangles of two sizes, drawn by area: their light is that of the rectangle.
  Scene scene = wall_scene();
  scene.materials.push_back(grey(0, 5));
  Mesh lamp;
  lamp.name = "lamp";
  lamp.material = 1;
  constexpr int n = 20;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double s = double(i) / n, t = double(j) / n;
      lamp.positions.push_back({s * s * 40_mm, t * 20_mm, -0.27});  // finer toward x = 0
    }
  for (uint32_t j = 0; j < n; ++j)
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t a = j * (n + 1) + i, b = a + n + 1;
      lamp.triangles.push_back({a, a + 1, b + 1});
      lamp.triangles.push_back({a, b + 1, b});
    }
  scene.meshes.push_back(lamp);
  const Statistics found = follow(scene, {{0, 0, -0.28}, {0, 0, -1}}, 40000, 2);
  EXPECT_NEAR(found.mean(), 0.6 * 5 * corner_view_factor(40_mm, 20_mm, 30_mm), 4 * found.standard_error());
  EXPECT_LT(found.standard_error(), 0.01 * found.mean());
}

TEST(Light, AMirrorShowsTheInvisibleRectangleThatThePanelDoesNotSee) {
  Scene scene;
  scene.materials = {{ConductorMaterial{constant_index(3), 0}}};  // at normal incidence (3 − 1)²/(3 + 1)² = 1/4
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.lights = {RectangleLight{{-5_mm, -5_mm, -0.25}, {0, 10_mm, 0}, {10_mm, 0, 0}, {8, 8, 8}, false}};
  constexpr int paths = 40000;
  // The ray passes through the back of the rectangle. One path of four comes back, and brings 8.
  const Statistics found = follow(scene, {{1_mm, 2_mm, 0}, {0, 0, -1}}, paths, 1);
  EXPECT_NEAR(found.mean(), 2, 4 * 8 * std::sqrt(0.25 * 0.75 / paths));
  EXPECT_EQ(follow(scene, {{6_mm, 2_mm, 0}, {0, 0, -1}}, 1000, 1).mean(), 0) << "beside its image";
}

TEST(Light, ALampInThePlaneOfACeilingShinesLikeOneJustBelowIt) {
  // A rough metal floor finds the lamp mostly by meeting it; the ceiling is at exactly the same distance.
  const auto radiance = [](double gap, const Frame& turn, bool is_visible) {
    const Vec3 middle{0, 0, -0.3};
    const auto placed = [&](Vec3 v) { return transform_vector(turn, v) + middle; };
    Scene scene;
    scene.materials = {{ConductorMaterial{metal_index("Ag"), 0.2}}, grey(0)};
    const Vec3 x = transform_vector(turn, {20_mm, 0, 0}), y = transform_vector(turn, {0, 20_mm, 0});
    scene.meshes = {make_test_quad(placed({0, 0, -2_mm}), x, y, 0), make_test_quad(placed({0, 0, 2_mm}), y, x, 1)};
    scene.lights = {RectangleLight{placed({-20_mm, -20_mm, 2_mm - gap}), y * 2, x * 2, {1, 1, 1}, is_visible}};
    return follow(scene, {placed({0, 0, 0}), transform_vector(turn, normalize({0.3, 0.2, -1}))}, 4000, 1);
  };
  for (const bool is_visible : {false, true})
    for (const Frame& turn : {Frame{}, rotation_x(0.3)}) {
      const Statistics in_plane = radiance(0, turn, is_visible), below = radiance(1e-6, turn, is_visible);
      EXPECT_GT(below.mean(), 0.9);  // the metal reflects nearly all of a sky that is bright nearly everywhere
      EXPECT_NEAR(in_plane.mean(), below.mean(), 4 * std::hypot(in_plane.standard_error(), below.standard_error()));
    }
}

TEST(Light, InvisibleRectanglesBlockNoLight) {
  Scene scene = wall_scene();
  scene.lights = {PointLight{{0, 0, -0.26}, {1, 1, 1}}};
  const double alone = follow(scene, onto_the_wall, 1, 1).mean();
  scene.lights.push_back(RectangleLight{{-5_mm, -5_mm, -0.28}, {10_mm, 0, 0}, {0, 10_mm, 0}, {1, 1, 1}, false});
  EXPECT_EQ(follow(scene, onto_the_wall, 1, 1).mean(), alone) << "it shines the other way";
}

TEST(Light, ALightInsideAWallIsDarkAndNoError) {
  Scene scene = wall_scene();
  scene.meshes.push_back(make_wall(-0.302, 10_mm, 10_mm));
  scene.meshes.push_back(make_wall(-0.26, 10_mm, 10_mm));
  for (const double z : {-0.301, -0.3, -0.302}) {
    scene.lights = {PointLight{{0, 0, z}, {1, 1, 1}}, SpotLight{{0, 0, z}, {0, 0, 1}, {1, 1, 1}, 0.1, 0.2},
                    RectangleLight{{-1_mm, -1_mm, z}, {2_mm, 0, 0}, {0, 2_mm, 0}, {1, 1, 1}}};
    for (const Vec3 radiance : [&] {
           PathCounts counts;
           return radiances(scene, {{2_mm, 3_mm, -0.28}, {0, 0, -1}}, 100, 1, counts);
         }())
      ASSERT_EQ(radiance, Vec3{}) << z;
  }
}

}  // namespace
}  // namespace holotrace
