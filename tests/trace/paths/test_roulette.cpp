#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/data/shapes.h"
#include "trace/follow.h"

// Russian roulette: where it begins, what it costs, and that the mean does not depend on it.

namespace holotrace {
namespace {

TEST(Roulette, BeginsAtItsSurface) {
  // In a closed furnace each of the first d surfaces is reached, and j > d by ρʲ⁻¹ of the paths: d + ρᵈ/(1 − ρ) in the
  // mean. The radiance, 1/(1 − ρ), does not depend on d.
  constexpr int count = 20000;
  const double rho = 0.6;
  const Scene scene = make_box_scene({0, 0, -0.3}, {0.1, 0.1, 0.1}, grey(rho, 1));
  const Ray ray{{0.01, 0.02, -0.29}, normalize({0.3, 0.2, -1})};
  for (const int depth : {1, 2, 4, 7}) {
    PathCounts counts;
    Statistics radiance;
    for (const Vec3 found : radiances(scene, ray, count, {.max_depth = unlimited, .roulette_depth = depth}, counts))
      radiance.add(found.y);
    // Beyond surface d: lengths n with P(n ≥ k) = ρᵈ⁺ᵏ⁻¹, E n² = ρᵈ(1 + ρ)/(1 − ρ)²; 4 standard errors.
    const double beyond = std::pow(rho, depth) / (1 - rho);
    const double variance = std::pow(rho, depth) * (1 + rho) / ((1 - rho) * (1 - rho)) - beyond * beyond;
    EXPECT_NEAR(counts.mean_path_length(), depth + beyond, 4 * std::sqrt(variance / count)) << depth;
    EXPECT_NEAR(radiance.mean(), 1 / (1 - rho), 4 * radiance.standard_error()) << depth;
  }
}

TEST(Roulette, LeavesTheLightOfFirstSurfacesWithoutNoise) {
  // A floor of reflectance 0.5 under an even background of 1: each path that goes on finds the same light.
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.background = {1, 1, 1};
  const Statistics found = follow(scene, {{}, {0, 0, -1}}, 1000, 8);
  EXPECT_NEAR(found.mean(), 0.5, 1e-12);  // the rounding of a sum
  EXPECT_LT(found.standard_error(), 1e-12);
}

TEST(Roulette, EndsPathsAtBlackSurfaces) {
  const Scene scene = make_box_scene({0, 0, -0.3}, {0.1, 0.1, 0.1}, grey(0, 1));
  PathCounts counts;
  radiances(scene, {{0.01, 0.02, -0.29}, normalize({0.3, 0.2, -1})}, 100, unlimited, counts);
  EXPECT_EQ(counts.mean_path_length(), 1);
  EXPECT_EQ(counts.absorbed, 100);
}

TEST(Roulette, TakesNoPathForTheRadianceScaleOfGlass) {
  // An emitting wall through a slab: at normal incidence (1 − R)² ≈ 0.92 is transmitted directly, the rest by
  // reflections between the faces or not at all. Chosen by fraction, paths spread by √(p(1 − p)) ≈ 0.27. Roulette on
  // the factor n² = 2.25 that radiance gains and loses would end 5 of 9 paths, and the spread would be 1.
  Scene scene;
  scene.materials = {grey(0, 1), {DielectricMaterial{}}};
  Mesh slab = make_box({20_mm, 20_mm, 2_mm});
  for (Vec3& p : slab.positions) p = p + Vec3{0, 0, -0.28};
  slab.material = 1;
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm), slab};
  const Statistics found = follow(scene, {{0, 0, 0}, {0, 0, -1}}, 4000, 16);
  EXPECT_NEAR(found.mean(), 0.92, 0.03);  // 4 times 0.27/√4000, plus light reflected by more than two faces
  EXPECT_LT(found.standard_error() * std::sqrt(4000.0), 0.4);
}

TEST(Roulette, CountsCutPathsInProportionToTheirLight) {
  // Behind surface d the light of a furnace of albedo ρ is ρᵈ of the first, wherever roulette begins and whether or not
  // light beyond surfaces must be looked for; 4 standard errors of a binomial.
  constexpr int count = 20000, last = 3;
  const double share = 0.7 * 0.7 * 0.7, error = std::sqrt(share * (1 - share) / count);
  Scene scene = make_box_scene({0, 0, -0.3}, {0.1, 0.1, 0.1}, grey(0.7, 1));
  for (const Vec3 background : {Vec3{}, Vec3{1, 1, 1}}) {
    scene.background = background;
    for (const int depth : {1, 2, 4}) {
      PathCounts counts;
      radiances(scene, {{0.01, 0.02, -0.29}, normalize({0.3, 0.2, -1})}, count,
                {.max_depth = last, .roulette_depth = depth}, counts);
      EXPECT_NEAR(double(counts.cut) / count, share, 4 * error) << depth;
      EXPECT_EQ(counts.cut + counts.absorbed, count) << depth;
    }
  }
}

TEST(Roulette, RefusesASurfaceBeforeTheFirst) {
  const Scene scene = make_box_scene({0, 0, -0.3}, {0.1, 0.1, 0.1}, grey(0.5));
  EXPECT_EQ(error_of([&] { PathScene(scene, Lines{}, {}, {.roulette_depth = 0}); }),
            "expected a roulette_depth of 1 surface or more, got 0");
}

}  // namespace
}  // namespace holotrace
