#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>

#include "holotrace/data/refractive_index.h"
#include "holotrace/data/shapes.h"
#include "holotrace/trace/materials/bsdf.h"
#include "trace/follow.h"

// Light through glass that bends red, green and blue differently: against Snell's law, and against glass that bends all as one of
// them is bent, line by line.

namespace holotrace {
namespace {

/// Far more dispersive than any glass, so that colours are well apart.
const RefractiveIndex strong{{{460e-9, 1.8, 0}, {532e-9, 1.6, 0}, {630e-9, 1.45, 0}}};

double index_at_line(size_t line) { return index_at(strong, Lines{}.wavelengths[line]).real(); }

/// Mean radiance at each line along a ray, over rays that a camera follows together.
std::array<Statistics, 3> look(const Scene& scene, const Ray& ray, int blocks, const PathParams& params,
                               const std::vector<std::string>& groups = {}) {
  const PathScene path_scene(scene, Lines{}, groups, params);
  std::array<Statistics, 3> statistics;
  std::array<NumberedRay, most_together> rays;
  for (uint32_t i = 0; i < rays.size(); ++i) rays[i] = {ray, i};
  std::array<Vec3, most_together> lights;
  PathCounts counts;
  for (int block = 0; block < blocks; ++block) {
    LowDiscrepancy numbers(params.seed, 0, uint64_t(block));
    numbers.start(0);
    find_radiance(path_scene, rays, 0, numbers, lights, counts);
    const Vec3 sum = std::accumulate(lights.begin(), lights.end(), Vec3{});
    for (size_t line = 0; line < 3; ++line) statistics[line].add(component(sum, line) / most_together);
  }
  return statistics;
}

/// Expects what is seen of a scene to be, line by line, what is seen with glass of the constant index that the line has.
/// @param make  the scene with glass of an index
/// @param most  largest standard error, as a part of the mean: the test is blind to smaller faults
template <class Make>
void expect_as_line_by_line(const Make& make, const Ray& ray, int blocks, const PathParams& params, double most) {
  const auto all = look(make(strong), ray, blocks, params);
  for (size_t line = 0; line < 3; ++line) {
    PathParams own = params;
    own.seed += 1 + line;
    const auto one = look(make(constant_index(index_at_line(line))), ray, blocks, own)[line];
    const double error = std::hypot(all[line].standard_error(), one.standard_error());
    EXPECT_GT(one.mean(), 0) << line;
    EXPECT_LT(error, most * one.mean()) << line;
    EXPECT_NEAR(all[line].mean(), one.mean(), 4 * error) << line;
  }
}

/// A wall that scatters, with a ball of glass in front of it.
Scene make_wall_and_ball(const Material& glass) {
  Scene scene;
  scene.materials = {grey(0.6), glass};
  scene.meshes = {make_wall(-0.3, 40_mm, 40_mm), make_sphere(10_mm, 60)};
  scene.meshes[1].material = 1;
  for (Vec3& p : scene.meshes[1].positions) p.z -= 0.285;
  return scene;
}

Scene with_lamp(Scene scene, const Light& light) {
  scene.lights = {light};
  return scene;
}

const PointLight far_point{{1_mm, 2_mm, -0.22}, {1, 1, 1}};
RectangleLight rectangle(double side) {
  return {{-side / 2, -side / 2, -0.22}, {0, side, 0}, {side, 0, 0}, Vec3{1, 1, 1} / (side * side), false};
}
// A place of the wall in the light that the ball focuses, seen beside the ball.
const Ray to_focus{{30_mm, 0, -0.288}, normalize(Vec3{-29_mm, 0, -12_mm})};

// A wedge whose first face is met at a right angle: at the second, inclined by A, Snell's law bends a line of index n by
// asin(n·sin A) − A. Where it arrives, three bright cards stand, of which each line meets its own.
TEST(Dispersion, APrismSendsEachLineWhereSnellsLawDoes) {
  constexpr double apex = 0.3, away = 100_mm, half = 1_mm;
  const Vec3 middle{0, 0, -0.1};
  const auto way_of = [&](double n) {
    const double turn = std::asin(n * std::sin(apex)) - apex;
    return Vec3{std::sin(turn), 0, -std::cos(turn)};
  };
  // Transmittances of both faces, of unpolarised light.
  const auto passed = [&](double n) {
    const double into = 1 - std::pow((n - 1) / (n + 1), 2), inside = std::cos(apex),
                 outside = std::sqrt(1 - std::pow(n * std::sin(apex), 2));
    const double s = (n * inside - outside) / (n * inside + outside),
                 p = (n * outside - inside) / (n * outside + inside);
    return into * (1 - (s * s + p * p) / 2);
  };
  for (size_t card = 0; card < 3; ++card) {
    Scene scene;
    scene.materials = {DielectricMaterial{.index = strong}, grey(0, 1)};
    // The second face's normal points to −x, so that light leaves toward +x.
    const Vec3 second{-std::sin(apex), 0, -std::cos(apex)}, across{std::cos(apex), 0, -std::sin(apex)};
    scene.meshes = {make_test_quad(middle + Vec3{0, 0, 5_mm}, {10_mm, 0, 0}, {0, 10_mm, 0}),
                    make_test_quad(middle, {0, 10_mm, 0}, across * 10_mm)};
    ASSERT_GT(dot(cross(Vec3{0, 1, 0}, across), second), 0);
    const Vec3 way = way_of(index_at_line(card));
    scene.meshes.push_back(make_test_quad(middle + way * away, Vec3{-way.z, 0, way.x} * half, Vec3{0, 10_mm, 0}, 1));
    const auto seen = look(scene, {{0, 0, 0}, {0, 0, -1}}, 3000, {}, {"ESSL"});
    for (size_t line = 0; line < 3; ++line) {
      const double expected = line == card ? passed(index_at_line(line)) : 0;
      EXPECT_NEAR(seen[line].mean(), expected, 4 * seen[line].standard_error()) << card << line;
    }
    EXPECT_LT(seen[card].standard_error(), 0.01);
  }
}

// Lamps that no path can meet: found by bundles of rays for each line.
TEST(Dispersion, CausticsOfAPointAreThoseOfEachLine) {
  const auto make = [](const RefractiveIndex& index) {
    return with_lamp(make_wall_and_ball(DielectricMaterial{.index = index}), far_point);
  };
  expect_as_line_by_line(make, to_focus, 2000, {.max_depth = 4}, 0.03);
  // A clamp, here never reached, follows the paths one by one.
  expect_as_line_by_line(make, to_focus, 2000, {.max_depth = 4, .clamp = 1e300}, 0.03);
}

// Lamps that bundles and paths find, and share.
TEST(Dispersion, CausticsOfARectangleAreThoseOfEachLine) {
  const auto make = [](const RefractiveIndex& index) {
    return with_lamp(make_wall_and_ball(DielectricMaterial{.index = index}), rectangle(2_mm));
  };
  expect_as_line_by_line(make, to_focus, 4000, {.max_depth = 4}, 0.03);
  expect_as_line_by_line(make, to_focus, 4000, {.max_depth = 4, .asks_at_end = true}, 0.05);
}

// Light that paths alone find: rough glass, layers over glass, and the reflection on a flat face of a lamp that has no area.
TEST(Dispersion, RoughGlassAndReflectionsAreThoseOfEachLine) {
  const Ray through{{2_mm, 1_mm, 0}, {0, 0, -1}};
  const auto rough = [](const RefractiveIndex& index) {
    return with_lamp(make_wall_and_ball(DielectricMaterial{.index = index, .roughness = 0.4}), rectangle(30_mm));
  };
  expect_as_line_by_line(rough, through, 20000, {.max_depth = 6}, 0.03);
  const auto layers = [](const RefractiveIndex& index) {
    PrincipledMaterial material;
    material.transmission = {1};
    material.roughness = {0.4};
    material.index = index;
    return with_lamp(make_wall_and_ball(material), rectangle(30_mm));
  };
  expect_as_line_by_line(layers, through, 20000, {.max_depth = 6}, 0.03);
  const auto slab = [](const RefractiveIndex& index) {
    Scene scene;
    scene.materials = {grey(0.6), DielectricMaterial{.index = index}};
    scene.meshes = {make_wall(-0.3, 40_mm, 40_mm), make_test_quad({0, -10_mm, -0.28}, {0, 0, 20_mm}, {20_mm, 0, 0}, 1)};
    scene.lights = {PointLight{{0, 5_mm, -0.28}, {1, 1, 1}}};
    return scene;
  };
  expect_as_line_by_line(slab, {{0, 0, 0}, normalize(Vec3{0, -5_mm, -0.3})}, 200, {.max_depth = 2}, 0.01);
}

// What an analyser lets pass of light that the glass reflects near Brewster's angle, and of light that it bends.
TEST(Dispersion, PolarizedLightIsThatOfEachLine) {
  const auto make = [](const RefractiveIndex& index) {
    Scene scene = with_lamp(make_wall_and_ball(DielectricMaterial{.index = index}), rectangle(30_mm));
    scene.analyser = linear_polariser(0.4);
    return scene;
  };
  // 57 degrees off the normal of the ball, and through it.
  for (const double x : {8.4_mm / 2, 2_mm})
    expect_as_line_by_line(make, {{x, 0.5_mm, 0}, {0, 0, -1}}, 8000, {.max_depth = 6}, 0.05);
}

// A mirror of dispersive glass at Brewster's angle of its index in green: none of that light is polarised in the plane of incidence, but
// some of red and blue, which have other angles. Fresnel's R_p for each.
TEST(Dispersion, EachLineHasABrewsterAngleOfItsOwn) {
  const double angle = std::atan(index_at_line(1)), sine = std::sin(angle), cosine = std::cos(angle);
  const Vec3 middle{0, 0, -0.1}, away{std::sin(2 * angle), 0, std::cos(2 * angle)};
  Scene scene;
  scene.materials = {DielectricMaterial{.index = strong}, grey(0, 1)};
  scene.meshes = {make_test_quad(middle, Vec3{cosine, 0, -sine} * 5_mm, {0, 5_mm, 0}),
                  make_test_quad(middle + away * 0.05, Vec3{-away.z, 0, away.x} * 5_mm, {0, 5_mm, 0}, 1)};
  scene.analyser = linear_polariser(0);  // along x, in the plane of incidence
  const auto seen = look(scene, {{0, 0, 0}, {0, 0, -1}}, 4000, {}, {"ESL"});
  for (size_t line = 0; line < 3; ++line) {
    const double n = index_at_line(line), inside = std::sqrt(1 - sine * sine / (n * n));
    const double p = (n * cosine - inside) / (n * cosine + inside);
    EXPECT_NEAR(seen[line].mean(), 0.5 * p * p, 4 * seen[line].standard_error() + 1e-12) << line;
    EXPECT_LT(seen[line].standard_error(), 1e-4) << line;
  }
}

// Light that meets no dispersive glass keeps its three lines on one path: grey things have no coloured noise.
TEST(Dispersion, GreyThingsBesideGlassStayGreyOnEveryPath) {
  const Scene scene = with_lamp(make_wall_and_ball(DielectricMaterial{.index = strong}), rectangle(30_mm));
  const PathScene path_scene(scene, Lines{}, {"ED+L"}, {});
  ASSERT_TRUE(path_scene.parts_lines);
  const Ray beside_ball{{30_mm, 0, -0.288}, normalize(Vec3{-10_mm, 0, -12_mm})};
  PathCounts counts;
  int lit = 0;
  for (uint64_t sample = 0; sample < 200; ++sample) {
    LowDiscrepancy numbers(1, 0, sample);
    numbers.start(0);
    Vec3 light;
    add_radiance(path_scene, beside_ball, numbers, {&light, 1}, counts);
    EXPECT_EQ(light.x, light.y);
    EXPECT_EQ(light.x, light.z);
    lit += light.x > 0;
  }
  EXPECT_GT(lit, 100);
}

TEST(Dispersion, OnlyOfLinesThatDifferNeedsAHero) {
  const Scene dispersive = make_wall_and_ball(DielectricMaterial{.index = strong}),
              even = make_wall_and_ball(DielectricMaterial{.index = constant_index(1.6)}),
              thin = make_wall_and_ball(DielectricMaterial{.index = strong, .is_thin = true});
  EXPECT_TRUE(PathScene(dispersive, Lines{}, {}, {}).parts_lines);
  EXPECT_FALSE(PathScene(dispersive, make_lines(532e-9, 532e-9, 532e-9), {}, {}).parts_lines);
  EXPECT_FALSE(PathScene(even, Lines{}, {}, {}).parts_lines);
  // A picture in the light of one laser: its index counts for all lines, and none is lost.
  Lines of_laser;
  of_laser.glass_wavelength = 460e-9;
  const PathScene blue(dispersive, of_laser, {}, {});
  EXPECT_FALSE(blue.parts_lines);
  SurfacePoint front;
  front.normal = front.geometric_normal = {0, 0, 1};
  const Bsdf bsdf = make_bsdf(dispersive.materials[1], front, blue.lines);
  EXPECT_EQ(std::get<DielectricBsdf>(bsdf).index, 1.8);
  EXPECT_EQ(std::get<DielectricBsdf>(bsdf).indices, (Vec3{1.8, 1.8, 1.8}));
  EXPECT_FALSE(PathScene(thin, Lines{}, {}, {}).parts_lines) << "it sends all straight on";
}

}  // namespace
}  // namespace holotrace
