#include <gtest/gtest.h>

#include <complex>

#include "holotrace/data/shapes.h"
#include "holotrace/trace/materials/fresnel.h"
#include "trace/follow.h"

// The phase of light from a laser.

namespace holotrace {
namespace {

Phasors phasors_of(const Scene& scene, const Ray& ray, int paths, int max_depth, const Lines& lines = {},
                   uint64_t sample = 0) {
  const PathScene path_scene(scene, lines, {}, {.max_depth = max_depth});
  std::vector<Phasors> sums(size_t(path_scene.sums()));
  PathCounts counts;
  laser_phasors(path_scene, start_of(path_scene, ray), paths, sample, sums, counts);
  return sums[0];
}

/// Difference of two phases around the circle [rad].
double phase_difference(double a, double b) { return std::abs(std::remainder(a - b, 2 * pi)); }

TEST(LaserPhasors, OneLaserGivesTheRootOfTheRadianceAndThePhaseOfItsWay) {
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.lights = {PointLight{{30_mm, 0, -0.26}, {1, 2, 3}, true}};
  const Ray ray{{0, 0, 0}, {0, 0, -1}};
  const Phasors u = phasors_of(scene, ray, 7, 1);
  for (size_t line = 0; line < 3; ++line) {
    const double radiance = 0.6 / pi * double(line + 1) * 0.8 / (0.05 * 0.05);
    EXPECT_NEAR(std::norm(u[line]) / radiance, 1, 1e-9);
    // 0.05 m are 1e5 cycles: 1e-15 of them, times 2π, and the position of the wall to 1e-17 m.
    EXPECT_LT(phase_difference(std::arg(u[line]), 2 * pi * (0.05 / Lines{}.wavelengths[line])), 1e-8);
  }
}

TEST(LaserPhasors, AWayThatBeginsInWaterIsLongerByItsIndex) {
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.lights = {PointLight{{30_mm, 0, -0.26}, {1, 1, 1}, true}};
  const PathScene path_scene(scene, Lines{}, {}, {});
  PathStart start = start_of(path_scene, {{0, 0, 0}, {0, 0, -1}});
  start.index = 1.5;
  Phasors u{};
  PathCounts counts;
  laser_phasors(path_scene, start, 1, 0, {&u, 1}, counts);
  EXPECT_LT(phase_difference(std::arg(u[1]), 2 * pi * (1.5 * 0.05 / green_line)), 1e-8);
}

TEST(LaserPhasors, ABeamHasItsPhaseFromThePlaneThroughItsPosition) {
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  const Vec3 direction{0.6, 0, -0.8}, position{1_mm, 3_mm, -0.25};
  scene.lights = {DirectionalLight{direction, {1, 1, 1}, position, 40_mm, true}};
  for (const double x : {0.0, 3_mm}) {
    const Phasors u = phasors_of(scene, {{x, 0, 0}, {0, 0, -1}}, 1, 1);
    const double path = dot(Vec3{x, 0, -0.3} - position, direction);
    EXPECT_NEAR(std::norm(u[1]), 0.6 / pi * 0.8, 1e-12);
    EXPECT_LT(phase_difference(std::arg(u[1]), 2 * pi * (path / green_line)), 1e-8);
  }
}

TEST(LaserPhasors, TwoLasersMakeYoungsFringes) {
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  const Vec3 first{50e-6, 0, -0.2}, second{-50e-6, 0, -0.2};
  scene.lights = {PointLight{first, {1, 1, 1}, true}, PointLight{second, {1, 1, 1}, true}};
  const double period = green_line * 0.1 / 100e-6;  // λL/s
  const auto brightness = [&](double x) { return std::norm(phasors_of(scene, {{x, 0, 0}, {0, 0, -1}}, 1, 1)[1]); };
  const double bright = brightness(0);
  // Off the axis by one period of half a millimetre, the paraxial law is off by (x/L)², 3e-5, and so is the cosine.
  for (const double cycles : {0.25, 0.5, 1.0})
    EXPECT_NEAR(brightness(cycles * period) / bright, std::pow(std::cos(pi * cycles), 2), 3e-4) << cycles;
}

TEST(LaserPhasors, TheWayThroughGlassCountsItsIndex) {
  // One face of glass at z = −0.3; 10 mm behind it inside the glass is a wall, and 6 mm in front of that the laser.
  Scene scene;
  scene.materials = {grey(0.6), {DielectricMaterial{constant_index(1.5), 0}}};
  scene.meshes = {make_wall(-0.31, 10_mm, 10_mm), make_wall(-0.3, 10_mm, 10_mm, 1)};
  scene.lights = {PointLight{{0, 0, -0.304}, {1, 1, 1}, true}};
  const Ray ray{{1_mm, 0, 0}, {0, 0, -1}};
  const Phasors u = phasors_of(scene, ray, 64, 2);
  const double path = 1.5 * (std::hypot(1_mm, 6_mm) + 10_mm);
  EXPECT_LT(phase_difference(std::arg(u[1]), 2 * pi * (path / green_line)), 1e-8);
  // All paths through the face have the same phase: their mean is the radiance, without speckle.
  const double mean = sums_of(scene, ray, {}, {.max_depth = 2}, 64)[0];
  EXPECT_GT(mean, 0);
  EXPECT_NEAR(std::norm(u[1]) / mean, 1, 1e-9);
}

// The start is moved along a mirror; the light reaches it from a place q on a wall, which stays. Its way is shorter by
// the move toward q, up to (5 µm)²/0.1 m: 3e-3 rad.
TEST(LaserPhasors, AMoveOfTheStartChangesTheWayToTheNextSurface) {
  Scene scene;
  scene.materials = {grey(0.6), ConductorMaterial{}};
  scene.meshes = {make_test_quad({0.1, 0, -0.3}, {10_mm, 0, 0}, {0, 10_mm, 0}, 1),
                  make_test_quad({0.1 + 0.1 / 3, 0, -0.2}, {0, 10_mm, 0}, {10_mm, 0, 0})};
  scene.lights = {PointLight{{0.15, 0, -0.25}, {1, 1, 1}, true}};
  const PathScene path_scene(scene, Lines{}, {}, {.max_depth = 2});
  PathStart start = start_of(path_scene, {{0, 0, 0}, normalize({0.1, 0, -0.3})});
  const auto phasor = [&](Vec3 move) {
    start.phase_move = move;
    Phasors u{};
    PathCounts counts;
    laser_phasors(path_scene, start, 1, 0, {&u, 1}, counts);
    return u[1];
  };
  const std::complex<double> still = phasor({});
  ASSERT_GT(std::norm(still), 0);
  const Vec3 here{0.1, 0, -0.3}, q{0.1 + 0.1 / 3, 0, -0.2};
  for (const Vec3 move : {Vec3{5_um, 0, 0}, Vec3{-3_um, 2_um, 0}}) {
    const double change = length(q - here - move) - length(q - here);
    const double found = std::arg(phasor(move) / still);
    EXPECT_LT(phase_difference(found, 2 * pi * change / green_line), 3e-3) << move.x;
  }
}

TEST(LaserPhasors, APaneAddsNoPathToTheWayThroughIt) {
  Scene scene;
  scene.materials = {grey(0.6), DielectricMaterial{.is_thin = true}};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.lights = {PointLight{{30_mm, 0, -0.26}, {1, 1, 1}, true}};
  const Ray ray{{}, {0, 0, -1}};
  const Phasors open = phasors_of(scene, ray, 4, 3);
  scene.meshes.push_back(make_test_quad({15_mm, 0, -0.28}, {5_mm, 0, 0}, {0, 5_mm, 0}, 1));
  const Phasors through = phasors_of(scene, ray, 4, 3);
  for (size_t line = 0; line < 3; ++line) {
    EXPECT_LT(phase_difference(std::arg(open[line]), std::arg(through[line])), 1e-12);
    const double reflected = reflectance_dielectric(0.8, 1.5);
    EXPECT_NEAR(std::norm(through[line]) / std::norm(open[line]), 1 - 2 * reflected / (1 + reflected), 1e-9);
  }
}

TEST(LaserPhasors, AMetalMirrorAddsFresnelsPhase) {
  // A mirror at 45°, a wall 20 mm beside it, and a laser in front of the wall. The phase is that of the path and of
  // r_s = (c − q)/(c + q), q = √(n² − s²), with c = s = √½: neither 0 nor π for silver.
  Scene scene;
  const RefractiveIndex silver = metal_index("Ag");
  scene.materials = {grey(0.6), ConductorMaterial{silver}};
  scene.meshes = {make_test_quad({20_mm, 0, -0.3}, {0, 0, 10_mm}, {0, 10_mm, 0}),
                  make_test_quad({0, 0, -0.3}, {5_mm, 0, -5_mm}, {0, 5_mm, 0}, 1)};
  const Vec3 laser{12_mm, 6_mm, -0.3};
  scene.lights = {PointLight{laser, {1, 1, 1}, true}};
  const Phasors u = phasors_of(scene, {{0, 0, 0}, {0, 0, -1}}, 8, 2);
  const double c = std::sqrt(0.5), path = 20_mm + std::hypot(8_mm, 6_mm);
  for (size_t line = 0; line < 3; ++line) {
    const std::complex<double> index = index_at(silver, Lines{}.wavelengths[line]), q = std::sqrt(index * index - 0.5),
                               reflected = (c - q) / (c + q);
    const double phase = 2 * pi * path / Lines{}.wavelengths[line] + std::arg(reflected);
    // The places of the surfaces are known to 1e-14 m or better (1e-7 rad); without its phase the mirror is off by 2.6 rad.
    EXPECT_GT(std::norm(u[line]), 0);
    EXPECT_LT(phase_difference(std::arg(u[line]), phase), 1e-6) << std::arg(reflected);
  }
}

TEST(LaserPhasors, SpeckleHasTheMeanRadiance) {
  // In a diffuse box most light comes by way of walls: E|U|² = L.
  Scene scene = make_box_scene({0, 0, -0.3}, {10_mm, 8_mm, 6_mm}, grey(0.8));
  const Ray ray{{1_mm, 1_mm, -0.3}, normalize({0.3, -0.5, 0.2})};
  for (const bool is_laser : {true, false}) {
    scene.lights = {PointLight{{2_mm, 3_mm, -0.302}, {1e-4, 1e-4, 1e-4}, is_laser}};
    Statistics speckle;
    for (uint64_t sample = 0; sample < 4000; ++sample)
      speckle.add(std::norm(phasors_of(scene, ray, 4, 20, {}, sample)[1]));
    const double mean = sums_of(scene, ray, {}, {.max_depth = 20}, 100000)[0];
    EXPECT_NEAR(speckle.mean(), mean, 4 * speckle.standard_error() + 0.01 * mean);
  }
}

}  // namespace
}  // namespace holotrace
