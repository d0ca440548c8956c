#include <gtest/gtest.h>

#include <complex>

#include "holotrace/trace/materials/bsdf.h"
#include "trace/follow.h"

// Light of lamps that no ray can meet, by flat mirrors.

namespace holotrace {
namespace {

constexpr double reflectance_of_wall = 0.6;

/// A wall at z = −0.3 m, and a mirror at right angles to it in the plane x = −20 mm.
Scene make_wall_beside_mirror(const Material& mirror) {
  Scene scene;
  scene.materials = {grey(reflectance_of_wall), mirror};
  scene.meshes = {make_wall(-0.3, 15_mm, 15_mm), make_test_quad({-20_mm, 0, -0.25}, {0, 30_mm, 0}, {0, 0, 45_mm}, 1)};
  return scene;
}

double radiance_at_origin(const Scene& scene, const std::vector<std::string>& groups = {}, int max_depth = 2) {
  const PathScene path_scene(scene, Lines{}, groups, {.max_depth = max_depth});
  const PathStart start = start_of(path_scene, {{}, {0, 0, -1}});
  std::vector<Vec3> sums(size_t(path_scene.sums()));
  PathCounts counts;
  mean_radiance(path_scene, start, 20, 0, sums, counts);
  return sums.back().y;
}

/// The same of a lamp of intensity 1 at a place, straight: ρ/π·cosθ/d².
double straight(Vec3 lamp) {
  const Vec3 way = lamp - Vec3{0, 0, -0.3};
  return reflectance_of_wall / pi * way.z / length(way) / dot(way, way);
}

/// Reflectance of the mirror for the way from the wall's middle to a place.
double reflected_share(const Material& mirror, Vec3 image) {
  const Vec3 way = normalize(image - Vec3{0, 0, -0.3});
  SurfacePoint point;
  point.normal = point.geometric_normal = {1, 0, 0};
  const SpecularBranches branches = specular_branches(make_bsdf(mirror, point, Lines{}), -way);
  for (int i = 0; i < branches.count; ++i)
    if (!branches.ways[size_t(i)].is_transmission) return branches.ways[size_t(i)].weight.y;
  return 0;
}

// The image of a lamp behind the mirror is before it: no light comes from there.
TEST(FlatMirrors, ReflectNoLightOfLampsBehindThem) {
  Scene scene = make_wall_beside_mirror(ConductorMaterial{});
  scene.lights = {PointLight{{-30_mm, 5_mm, -0.27}, {1, 1, 1}}};
  EXPECT_EQ(radiance_at_origin(scene), 0);  // the mirror hides the lamp itself
}

TEST(FlatMirrors, ShowLampsAsTheirImages) {
  const Vec3 lamp{10_mm, 5_mm, -0.27}, image{-50_mm, 5_mm, -0.27};
  for (const Material& mirror : {Material(ConductorMaterial{}), Material(DielectricMaterial{.is_thin = true})}) {
    Scene scene = make_wall_beside_mirror(mirror);
    const double share = reflected_share(mirror, image);
    EXPECT_GT(share, 0.05);
    scene.lights = {PointLight{lamp, {1, 1, 1}}};
    EXPECT_NEAR(radiance_at_origin(scene), straight(lamp) + share * straight(image), 1e-9 * straight(lamp));
    // Paths of one surface have no mirror on them.
    EXPECT_NEAR(radiance_at_origin(scene, {}, 1), straight(lamp), 1e-9 * straight(lamp));
    // Of the light that a mirror has reflected, only the image is left.
    EXPECT_NEAR(radiance_at_origin(scene, {"EDSL"}), share * straight(image), 1e-9 * straight(lamp));
    // A lamp behind the mirror does not shine by it, nor through metal.
    scene.lights = {PointLight{image, {1, 1, 1}}};
    if (std::holds_alternative<ConductorMaterial>(mirror.surface)) {
      EXPECT_EQ(radiance_at_origin(scene), 0);
    }
  }
}

TEST(FlatMirrors, ReflectSpotsAndBeams) {
  const Material mirror{ConductorMaterial{}};
  Scene scene = make_wall_beside_mirror(mirror);
  // A spot that shines at the mirror alone: toward (−20, 0, −285) mm, the middle between the wall's middle and the image.
  const Vec3 lamp{20_mm, 0, -0.28}, image{-60_mm, 0, -0.28}, on_mirror{-20_mm, 0, -0.3 + 20_mm / 3};
  scene.lights = {SpotLight{lamp, normalize(on_mirror - lamp), {1, 1, 1}, 0.05, 0.1}};
  EXPECT_NEAR(radiance_at_origin(scene), reflected_share(mirror, image) * straight(image), 1e-9);
  // A beam toward −x and −z that the mirror turns to +x: parallel light of irradiance 1 at 45°.
  scene.lights = {DirectionalLight{normalize({-1, 0, -1}), {1, 1, 1}, {0, 0, -0.26}, 1_mm}};
  const double share = reflected_share(mirror, {-20_mm, 0, -0.28});
  EXPECT_NEAR(radiance_at_origin(scene), share * reflectance_of_wall / pi * std::sqrt(0.5), 1e-9);
}

TEST(FlatMirrors, AreHiddenByWhatIsBeforeThem) {
  Scene scene = make_wall_beside_mirror(ConductorMaterial{});
  const Vec3 lamp{10_mm, 5_mm, -0.27};
  scene.lights = {PointLight{lamp, {1, 1, 1}}};
  scene.materials.push_back(grey(0));
  // A card on the way from the mirror to the lamp: at x = −5 mm; then one on the way from the wall to the mirror, at −10 mm.
  // The way from the wall's middle to the image is 50 mm long in x. It meets the mirror after 20 mm, and is on its way back at
  // x = −5 mm after 35 mm; on its way there at x = −10 mm after 10 mm.
  for (const auto& [x, after] : {std::pair{-5_mm, 35_mm}, {-10_mm, 10_mm}}) {
    Scene hidden = scene;
    const double share = after / 50_mm;
    hidden.meshes.push_back(make_test_quad({x, 5_mm * share, -0.3 + 30_mm * share}, {0, 2_mm, 0}, {0, 0, 2_mm}, 2));
    EXPECT_NEAR(radiance_at_origin(hidden), straight(lamp), 1e-9 * straight(lamp)) << x;
  }
}

TEST(FlatMirrors, AreThePlanesOfMeshesThatReflect) {
  const auto mirrors_of = [](Scene scene) { return PathScene(scene, Lines{}, {}, {}).mirrors; };
  Scene scene = make_wall_beside_mirror(ConductorMaterial{});
  EXPECT_TRUE(mirrors_of(scene).empty());  // no lamp that needs them
  scene.lights = {PointLight{{0, 0, -0.1}, {1, 1, 1}}};
  EXPECT_EQ(mirrors_of(scene).size(), 1u);
  scene.meshes.push_back(make_round_mesh({0, 0, -0.2}, 5_mm, 12));
  scene.meshes.back().material = 1;
  EXPECT_EQ(mirrors_of(scene).size(), 1u);
  scene.meshes.back().material = 0;
  scene.materials[1] = ConductorMaterial{.roughness = 0.2};
  EXPECT_TRUE(mirrors_of(scene).empty());  // sampling a lamp from rough metal finds its light
}

// Lloyd's mirror: a laser h above a mirror and its image make fringes of the period λL/2h on a screen at the distance L: λ = 532 nm,
// L = 100 mm, h = 0.25 mm: 106.4 µm. Near grazing incidence the image has the opposite sign, so the mirror's edge is dark.
TEST(FlatMirrors, MakeLloydsFringes) {
  constexpr double height = 0.25_mm, distance = 100_mm;
  Scene scene;
  scene.materials = {grey(1), ConductorMaterial{.index = constant_index(1e-6)}};
  scene.meshes = {make_wall(-0.3, 15_mm, 15_mm), make_test_quad({0, 0, -0.25}, {0, 30_mm, 0}, {0, 0, 49.999_mm}, 1)};
  scene.lights = {PointLight{{height, 0, -0.3 + distance}, {1, 1, 1}, true}};
  const Lines lines = make_lines(green_light, green_light, green_light);
  const PathScene path_scene(scene, lines, {}, {.max_depth = 2});
  const auto light_at = [&](double x) {
    Phasors u{};
    PathCounts counts;
    laser_phasors(path_scene, start_of(path_scene, {{x, 0, -0.29}, {0, 0, -1}}), 4, 0, {&u, 1}, counts);
    return std::norm(u[1]);
  };
  const auto expected = [&](double x) {
    const auto wave = [&](double lamp) {
      const Vec3 way = Vec3{lamp, 0, -0.3 + distance} - Vec3{x, 0, -0.3};
      return std::polar(std::sqrt(way.z / length(way) / dot(way, way) / pi),
                        2 * pi * std::fmod(length(way) / green_light, 1.0));
    };
    return std::norm(wave(height) - wave(-height));
  };
  const double brightest = expected(53.2e-6);
  for (int k = 1; k <= 40; ++k) {
    const double x = k * 10e-6;
    // An index of 0 turns the phase by π − 2·cosθ, cosθ = (h + x)/L up to 6.5e-3: half of 0.013 of the brightest light.
    EXPECT_NEAR(light_at(x), expected(x), 7e-3 * brightest) << x;
  }
  EXPECT_LT(light_at(106.4e-6), 1e-3 * brightest);
  EXPECT_GT(light_at(53.2e-6), 0.999 * brightest);
}

}  // namespace
}  // namespace holotrace
