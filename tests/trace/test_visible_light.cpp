#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/trace/gather.h"
#include "holotrace/trace/paths/specular.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/shade_triangles.h"
#include "holotrace/trace/trace.h"
#include "trace/follow.h"

// Rectangle lights as surfaces: visible in all ways, and hiding what is behind them.

namespace holotrace {
namespace {

/// 20 mm × 20 mm in front of a wall of radiance 1, emitting toward the panel, or away from it.
Scene lamp_scene(bool shines_here) {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_wall(-0.3, 40_mm, 40_mm)};
  const Vec3 x{20_mm, 0, 0}, y{0, 20_mm, 0};
  scene.lights = {RectangleLight{{-10_mm, -10_mm, -0.2}, shines_here ? x : y, shines_here ? y : x, {5, 5, 5}}};
  return scene;
}

void set_visible(Scene& scene, bool is_visible) { std::get<RectangleLight>(scene.lights[0]).is_visible = is_visible; }

const Ray straight{{1_mm, 2_mm, 0}, {0, 0, -1}};

double radiance_of(const Scene& scene, const Ray& ray, Acceleration accelerator) {
  const PathScene path_scene(scene, Lines{}, {}, {.max_depth = 1, .accelerator = accelerator});
  std::vector<Vec3> sums(size_t(path_scene.sums()));
  PathCounts counts;
  mean_radiance(path_scene, start_of(path_scene, ray), 1, 0, sums, counts);
  return sums[0].y;
}

TEST(VisibleLight, IsBrightFromItsFrontBlackFromItsBackAndHidesTheWall) {
  for (const Acceleration accelerator : {Acceleration::embree, Acceleration::grid}) {
    Scene front = lamp_scene(true), back = lamp_scene(false);
    EXPECT_EQ(radiance_of(front, straight, accelerator), 5);
    EXPECT_EQ(radiance_of(back, straight, accelerator), 0);
    EXPECT_EQ(radiance_of(front, {{10.1_mm, 0, 0}, {0, 0, -1}}, accelerator), 1) << "beside it";
    set_visible(front, false);
    EXPECT_EQ(radiance_of(front, straight, accelerator), 1);
  }
}

TEST(VisibleLight, IsMetAtItsPlaceNotWhereRaysLookForIt) {
  const Scene scene = lamp_scene(true);
  for (const Acceleration accelerator : {Acceleration::embree, Acceleration::grid}) {
    const auto hit = Accelerator(scene, accelerator).closest_hit(straight);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->point.light, 0);
    EXPECT_NEAR(hit->distance, 0.2, 1e-15);  // roundings of 0.2 m
    EXPECT_EQ(hit->point.geometric_normal, (Vec3{0, 0, 1}));
  }
}

TEST(VisibleLight, ShadowsOtherLights) {
  // A point light of 1 W/sr 40 mm behind the wall's centre lights it by 1/(0.04²·π)·0.5; the lamp in between hides it.
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.lights = {RectangleLight{{-5_mm, -5_mm, -0.28}, {10_mm, 0, 0}, {0, 10_mm, 0}, {1, 1, 1}},
                  PointLight{{0, 0, -0.26}, {1, 1, 1}}};
  const Ray below{{0, 0, -0.29}, {0, 0, -1}};
  EXPECT_EQ(follow(scene, below, 1, 1).mean(), 0);
  set_visible(scene, false);
  EXPECT_NEAR(follow(scene, below, 1, 1).mean(), 0.5 / (pi * 0.04 * 0.04), 1e-9);
}

TEST(VisibleLight, LightsAWallAsMuchAskedForAsMetByChance) {
  // 40 mm × 20 mm, 30 mm in front of the wall, with a corner over the centre: ρ·L·F. Every path of two surfaces samples
  // it and may meet it. A nearly smooth metal finds it by meeting it, a rough one in both ways.
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.lights = {RectangleLight{{0, 0, -0.27}, {0, 20_mm, 0}, {40_mm, 0, 0}, {5, 5, 5}}};
  const Ray ray{{0, 0, -0.28}, {0, 0, -1}};
  const Statistics both = follow(scene, ray, 40000, 2);
  EXPECT_NEAR(both.mean(), 0.6 * 5 * corner_view_factor(0.04, 0.02, 0.03), 4 * both.standard_error());
  EXPECT_LT(both.standard_error(), 0.01 * both.mean()) << "else the line above claims little";
  for (const double roughness : {0.0, 0.15, 0.7}) {
    scene.materials[0] = ConductorMaterial{metal_index("Ag"), roughness};
    set_visible(scene, true);
    const Ray slanting{{-8_mm, -8_mm, -0.28}, normalize({8, 8, -20})};
    const Statistics seen = follow(scene, slanting, 40000, 2);
    set_visible(scene, false);
    const Statistics unseen = follow(scene, slanting, 40000, 2);  // the lamp hides nothing here
    EXPECT_GT(seen.mean(), 0.1);
    EXPECT_NEAR(seen.mean(), unseen.mean(), 4 * std::hypot(seen.standard_error(), unseen.standard_error()) + 1e-9)
        << roughness;
  }
}

TEST(VisibleLight, IsSeenInAMirrorBeyondTheLastSurface) {
  // As for other lights, the surface of a lamp does not count for max_depth.
  Scene scene;
  scene.materials = {{ConductorMaterial{constant_index(3), 0}}};  // at normal incidence (3 − 1)²/(3 + 1)² = 1/4
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.lights = {RectangleLight{{-5_mm, -5_mm, -0.25}, {0, 10_mm, 0}, {10_mm, 0, 0}, {8, 8, 8}}};
  const Ray ray{{1_mm, 2_mm, -0.26}, {0, 0, -1}};
  const PathScene path_scene(scene, Lines{}, {}, {.max_depth = 1});
  PathCounts counts;
  const auto leaves = follow_specular(path_scene, ray, counts);
  ASSERT_EQ(leaves.size(), 1u);
  EXPECT_EQ(leaves[0].start.point.light, 0);
  EXPECT_NEAR(leaves[0].distance, 0.04 + 0.05, 1e-9);  // to the mirror and back to the lamp
  EXPECT_NEAR(leaves[0].weight.y, 0.25, 1e-12);
  constexpr int paths = 4000;
  EXPECT_NEAR(follow(scene, ray, paths, 1).mean(), 2, 4 * 8 * std::sqrt(0.25 * 0.75 / paths));
}

TEST(VisibleLight, BecomesWavesAsASurfaceThatShinesDoes) {
  // The same rectangle as a light and as a mesh: the same origins, and amplitudes √(L·dA)·cosθ.
  const Grid panel{64, 64, 8e-6};
  Scene with_light = lamp_scene(true), with_mesh = with_light;
  with_mesh.lights.clear();
  with_mesh.materials.push_back(grey(0, 5));
  with_mesh.meshes.push_back(make_wall(-0.2, 10_mm, 10_mm, 1));
  for (const Strategy strategy : {Strategy::shared, Strategy::tiled}) {
    const TraceParams params{.strategy = strategy, .columns = 8, .rows = 8, .field_of_view = 0.03, .paths = 1};
    const Sources lamp = trace(with_light, panel, green_light, params);
    const Sources mesh = trace(with_mesh, panel, green_light, params);
    ASSERT_EQ(lamp.waves.size(), 64u);
    ASSERT_EQ(mesh.waves.size(), 64u);
    int near = 0;
    for (size_t i = 0; i < 64; ++i) {
      EXPECT_LT(length(lamp.waves[i].origin - mesh.waves[i].origin), 1e-15);
      EXPECT_EQ(lamp.waves[i].amplitude, mesh.waves[i].amplitude);
      near += lamp.waves[i].origin.z > -0.25;
    }
    EXPECT_EQ(near, 64);  // the lamp fills the view: 10 mm at 200 mm is 0.05
    EXPECT_EQ(lamp.tiles.values, mesh.tiles.values);
  }
  // With separate lights its waves are a separate set; and a lamp alone is a valid scene.
  Scene alone;
  alone.points = {{{0, 0, -0.3}, 1, 0}};
  alone.lights = with_light.lights;
  TraceParams params{.columns = 4, .rows = 4, .field_of_view = 0.03, .paths = 1, .separate_lights = true};
  const auto sets = trace(alone, panel, std::vector<double>{green_light}, params);
  ASSERT_EQ(sets.size(), 1u) << "the point behind the lamp is hidden";
  EXPECT_EQ(sets[0].label.name, "light 0");
  EXPECT_EQ(sets[0].waves.size(), 16u);
}

TEST(VisibleLight, IsInThePictureTheGatheredFieldAndTheTriangles) {
  const Grid panel{8, 8, 8e-6};
  Scene scene = lamp_scene(true);
  const Image picture = render(scene, panel, green_light, {.rows = 4, .field_of_view = 0.03, .paths = 1});
  for (const float value : picture.values) EXPECT_EQ(value, 5);
  const std::vector<Triangles> shaded =
      shade_triangles(scene, panel, {green_light}, {.paths = 1}, Shading::flat, TrianglePhase::random);
  float nearest = -1;
  for (const Triangle& triangle : shaded[0].triangles) nearest = std::max(nearest, float(triangle.corners[0].z));
  EXPECT_NEAR(nearest, -0.2, 1e-7);
}

TEST(VisibleLight, GathersItsRadianceOverTheAcceptance) {
  // Cells of 1 nm: independent waves, whose mean irradiance is L·∫∫ dΩ over the acceptance, ±asin(λ/2p) on both axes,
  // 4s²(1 − s²/3). The lamp fills it: R = 6.65 mm at 200 mm. 8 waves per pixel have a contrast of √(1 − 1/8); 16384
  // pixels leave 0.73 % of noise.
  const Grid panel{128, 128, 8e-6};
  const TraceParams params{.strategy = Strategy::gather,
                           .pixel_samples = 8,
                           .paths = 1,
                           .max_depth = 1,
                           .phase = SourcePhase::surface,
                           .grain = 1e-9};
  const double s = green_light / 16e-6, solid_angle = 4 * s * s * (1 - s * s / 3);
  Scene scene = lamp_scene(true);
  for (const bool is_visible : {true, false}) {
    set_visible(scene, is_visible);
    const Field field = gather(scene, panel, {green_light}, params).front();
    const double irradiance = power(field) / (panel.width() * panel.height()), radiance = is_visible ? 5 : 1;
    EXPECT_NEAR(irradiance / (radiance * solid_angle), 1, 4 * 0.0073);
  }
}

TEST(VisibleLight, FarAwayLightsContactsAsTheSameLampNearby) {
  // A card 10 µm in front of a wall of 2 mm, lit by a lamp of 0.1 m at 0.1 m, and by one of 1 km at 1 km, with a corner
  // over the middle of both: ρ·L·F, F the sum over the lamp's four parts about the place. In the gap, 0.4 mm from the
  // card's edge, light comes only from 10/400 of the right angle at the horizon; the lamp, up to 45° high, is not
  // there.
  for (const double side : {0.1, 1000.0}) {
    Scene scene;
    scene.materials = {grey(0.6)};
    scene.meshes = {make_wall(-0.1, 1_mm, 1_mm), make_wall(-0.1 + 10_um, 0.5_mm, 0.5_mm)};
    scene.lights = {RectangleLight{{0, 0, -0.1 + side}, {0, side, 0}, {side, 0, 0}, {5, 5, 5}}};
    for (const double x : {0.8_mm, 0.1_mm}) {  // on the wall, on the card
      const double y = 0.1_mm, far_x = side - x, far_y = side - y;
      const double factor = corner_view_factor(x, y, side) + corner_view_factor(far_x, y, side) +
                            corner_view_factor(x, far_y, side) + corner_view_factor(far_x, far_y, side);
      const Statistics found = follow(scene, {{x, y, -0.05}, {0, 0, -1}}, 20000, 1);
      // The card is nearer by 10 µm: 1e-4 of 0.1 m, and twice that of F at most.
      EXPECT_NEAR(found.mean(), 0.6 * 5 * factor, 4 * found.standard_error() + 1e-4) << side << ", " << x;
      EXPECT_LT(found.standard_error(), 0.01 * found.mean()) << "else the line above claims little";
    }
    EXPECT_EQ(follow(scene, {{0.1_mm, 0.1_mm, -0.1 + 5_um}, {0, 0, -1}}, 2000, 1).mean(), 0) << side;
  }
}

TEST(VisibleLight, AloneIsAScene) {
  const Grid panel{8, 8, 8e-6};
  Scene alone = lamp_scene(true);
  alone.meshes.clear();
  alone.materials.clear();
  for (const float value : render(alone, panel, green_light, {.rows = 4, .field_of_view = 0.03, .paths = 1}).values)
    EXPECT_EQ(value, 5);
  const TraceParams params{.columns = 4, .rows = 4, .field_of_view = 0.03, .paths = 1};
  EXPECT_EQ(trace(alone, panel, green_light, params).waves.size(), 16u);
  const auto shaded = shade_triangles(alone, panel, {green_light}, {.paths = 1}, Shading::flat, TrianglePhase::random);
  EXPECT_FALSE(shaded[0].triangles.empty());
  set_visible(alone, false);  // a light and nothing that it could light
  EXPECT_EQ(error_of([&] { trace(alone, panel, green_light, params); }),
            "expected at least one object in the scene, a visible rectangle light, or a background, got none");
}

}  // namespace
}  // namespace holotrace
