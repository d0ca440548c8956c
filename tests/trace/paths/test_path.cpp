#include <gtest/gtest.h>

#include "holotrace/trace/shared/lanes.h"
#include "support/error_of.h"
#include "trace/follow.h"

namespace holotrace {
namespace {

TEST(Path, ClosedFurnaceHasRadianceAndPathLengthOneOverOneMinusAlbedo) {
  for (double rho : {0.2, 0.5, 0.9}) {
    const Scene scene = make_box_scene({0, 0, -0.3}, {10_mm, 8_mm, 6_mm}, grey(rho, 1));
    PathCounts counts;
    constexpr int paths = 40000;
    const Ray ray{{1_mm, 1_mm, -0.3}, normalize({0.3, -0.5, 0.2})};
    const Statistics radiance = follow(scene, ray, paths, {.max_depth = unlimited, .roulette_depth = 1}, counts);
    // A path has l surfaces, l geometric: mean 1/(1−ρ), variance ρ/(1−ρ)². If light were found by hits alone, its
    // radiance would be l; sampling the walls as well does not increase the variance.
    const double expected = 1 / (1 - rho), four_standard_errors = 4 * std::sqrt(rho / paths) / (1 - rho);
    EXPECT_NEAR(radiance.mean(), expected, four_standard_errors);
    EXPECT_NEAR(counts.mean_path_length(), expected, four_standard_errors);
    EXPECT_EQ(counts.escaped, 0) << "a closed box lets no path out";
    EXPECT_EQ(counts.cut, 0);
    EXPECT_EQ(counts.absorbed, paths);
  }
}

TEST(Path, HardlyAnyPathLeaksThroughTheEdgesOfAFineSphereFarFromTheOrigin) {
  constexpr double rho = 0.95;
  Scene scene;
  scene.materials = {grey(rho, 1)};
  scene.meshes = {make_round_mesh({0, 0, -0.3}, 10_mm, 64)};
  PathCounts counts;
  constexpr int paths = 20000;
  const Statistics radiance = follow(scene, {{1_mm, 2_mm, -0.301}, {0, 0, -1}}, paths, unlimited, counts);
  EXPECT_NEAR(radiance.mean(), 1 / (1 - rho), 4 * std::sqrt(rho / paths) / (1 - rho));
  // One in a million random rays may pass an edge (accelerator.h): 0.4 of them here, more than 4 by a chance of 6e-5.
  EXPECT_LE(counts.escaped, 4) << "of " << counts.rays << " rays";
}

TEST(Path, MaxDepthCutsTheFurnaceAfterThatManySurfaces) {
  constexpr double rho = 0.5;
  const Scene scene = make_box_scene({0, 0, -0.3}, {10_mm, 10_mm, 10_mm}, grey(rho, 1));
  PathCounts counts;
  constexpr int paths = 40000, depth = 3;
  const Statistics radiance = follow(scene, {{0, 0, -0.3}, {0, 0, -1}}, paths, depth, counts);
  // 1 + ρ + ρ² = (1 − ρ³)/(1 − ρ).
  EXPECT_NEAR(radiance.mean(), 1.75, 4 * radiance.standard_error());
  const double share = rho * rho * rho;  // fraction of paths that would have met a fourth surface
  EXPECT_NEAR(double(counts.cut), share * paths, 4 * std::sqrt(share * (1 - share) * paths));
}

TEST(Path, ColouredFurnaceHasEachChannelsOwnAnswer) {
  const Material material{DiffuseMaterial{.reflectance = {0.1, 0.4, 0.8}}, {1, 1, 1}};
  const Scene scene = make_box_scene({0, 0, -0.3}, {10_mm, 10_mm, 10_mm}, material);
  PathCounts counts;
  Statistics red, green, blue;
  for (const Vec3 radiance : radiances(scene, {{0, 0, -0.3}, {0, 0, -1}}, 40000, unlimited, counts))
    red.add(radiance.x), green.add(radiance.y), blue.add(radiance.z);
  EXPECT_NEAR(red.mean(), 1 / 0.9, 4 * red.standard_error());
  EXPECT_NEAR(green.mean(), 1 / 0.6, 4 * green.standard_error());
  EXPECT_NEAR(blue.mean(), 1 / 0.2, 4 * blue.standard_error());
}

TEST(Path, PointLightOverAPlaneGivesAlbedoOverPiTimesIrradiance) {
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.lights = {PointLight{{30_mm, 0, -0.26}, {1, 2, 3}}};
  PathCounts counts;
  // Seen at the centre: d = 50 mm, cosθ = 40/50. With one surface and a point light the direct light is not random.
  const Statistics radiance = follow(scene, {{0, 0, 0}, {0, 0, -1}}, 1, 1, counts);
  EXPECT_NEAR(radiance.mean(), 0.6 / pi * 2 * 0.8 / (0.05 * 0.05), 1e-9);
}

TEST(Path, BothSidesOfADiffuseSurfaceReflectAndEachOnlyItsOwnLight) {
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.lights = {PointLight{{0, 0, -0.26}, {1, 1, 1}}};
  PathCounts counts;
  EXPECT_GT(follow(scene, {{0, 0, 0}, {0, 0, -1}}, 1, 1, counts).mean(), 0);
  EXPECT_EQ(follow(scene, {{0, 0, -0.5}, {0, 0, 1}}, 1, 1, counts).mean(), 0);
  scene.lights = {PointLight{{0, 0, -0.34}, {1, 1, 1}}};
  EXPECT_EQ(follow(scene, {{0, 0, 0}, {0, 0, -1}}, 1, 1, counts).mean(), 0);
  EXPECT_GT(follow(scene, {{0, 0, -0.5}, {0, 0, 1}}, 1, 1, counts).mean(), 0);
}

TEST(Path, RectangleLightGivesItsClosedFormFactor) {
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  // 40 mm × 20 mm, 30 mm in front of the wall, facing it (edge_u × edge_v = −z), with a corner over the centre.
  scene.lights = {RectangleLight{{0, 0, -0.27}, {0, 20_mm, 0}, {40_mm, 0, 0}, {5, 5, 5}}};
  PathCounts counts;
  const Statistics radiance = follow(scene, {{0, 0, -0.28}, {0, 0, -1}}, 20000, 1, counts);
  EXPECT_NEAR(radiance.mean(), 0.6 * 5 * corner_view_factor(0.04, 0.02, 0.03), 4 * radiance.standard_error());
  EXPECT_LT(radiance.standard_error() / radiance.mean(), 0.01) << "else the line above claims little";

  // The other side of the light is dark.
  scene.lights = {RectangleLight{{0, 0, -0.27}, {40_mm, 0, 0}, {0, 20_mm, 0}, {5, 5, 5}}};
  EXPECT_EQ(follow(scene, {{0, 0, -0.28}, {0, 0, -1}}, 100, 1, counts).mean(), 0);
}

TEST(Path, EmissiveMeshAndRectangleLightOfTheSameShapeGiveTheSameLight) {
  // Both are sampled and met by paths, in different code.
  Scene scene;
  scene.materials = {grey(0.6), grey(0, 5)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm), make_test_quad({0, 0, -0.27}, {20_mm, 0, 0}, {0, 20_mm, 0}, 1)};
  PathCounts counts;
  const Ray ray{{0, 0, -0.28}, {0, 0, -1}};
  const Statistics hit = follow(scene, ray, 40000, 2, counts);
  EXPECT_NEAR(hit.mean(), 0.6 * 5 * 4 * corner_view_factor(0.02, 0.02, 0.03), 4 * hit.standard_error());
}

TEST(Path, AShadowIsBlack) {
  Scene scene;
  scene.materials = {grey(0.6), grey(0)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm), make_test_quad({0, 20_mm, -0.28}, {2_mm, 0, 0}, {0, 2_mm, 0}, 1)};
  scene.lights = {PointLight{{0, 40_mm, -0.26}, {1, 1, 1}}};  // half way to the centre of the wall; its shadow is ±4 mm
  PathCounts counts;
  EXPECT_EQ(follow(scene, {{0, 0, 0}, {0, 0, -1}}, 100, unlimited, counts).mean(), 0);
  EXPECT_GT(follow(scene, {{0, -8_mm, 0}, {0, 0, -1}}, 100, unlimited, counts).mean(), 0) << "beside the shadow";
}

TEST(Path, PathsThatLeaveBringTheBackground) {
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.background = {2, 2, 2};
  PathCounts counts;
  const Statistics radiance = follow(scene, {{0, 0, 0}, {0, 0, -1}}, 10000, unlimited, counts);
  EXPECT_NEAR(radiance.mean(), 0.6 * 2, 1e-12);  // a white sky on albedo 0.6; rounding: all paths find it
  EXPECT_EQ(counts.escaped + counts.absorbed, counts.paths);
}

TEST(Path, MoreRaysThanAreFollowedTogetherAreAnError) {
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  const PathScene path_scene(scene, Lines{}, {}, {});
  const std::vector<NumberedRay> rays(most_together + 1, {{{}, {0, 0, -1}}, 0});
  LowDiscrepancy numbers(1, 0, 0);
  numbers.start(0);
  std::vector<Vec3> lights(rays.size());
  PathCounts counts;
  const auto find = [&](std::span<const NumberedRay> some) {
    return error_of([&] { find_radiance(path_scene, some, 0, numbers, lights, counts); });
  };
  EXPECT_EQ(find(rays),
            "expected at most 16 rays that are followed together, and as many places for their light, got 17 and 17");
  EXPECT_EQ(find(std::span(rays).first(3)),
            "expected at most 16 rays that are followed together, and as many places for their light, got 3 and 17");
}

}  // namespace
}  // namespace holotrace
