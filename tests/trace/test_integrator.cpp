#include <gtest/gtest.h>

#include <complex>

#include "holotrace/base/random.h"
#include "holotrace/data/shapes.h"
#include "holotrace/trace/bsdf.h"
#include "holotrace/trace/environment.h"
#include "holotrace/trace/fresnel.h"
#include "trace/follow.h"

namespace holotrace {
namespace {

// --- the ways of finding light agree ---

/// A surface of that material before the panel, seen under 45°, and a lamp above it.
struct LampScene {
  Scene scene;
  Ray ray{{40_mm, 0, -0.26}, normalize({-1, 0, -1})};

  explicit LampScene(const Material& material) {
    scene.materials = {material, grey(0, 5)};
    scene.meshes = {make_wall(-0.3, 5_mm, 5_mm)};
  }
  void add_mesh_lamp() { scene.meshes.push_back(make_test_quad(centre, half_u, half_v, 1)); }
  void add_rectangle_lamp() {
    scene.lights.push_back(RectangleLight{centre - half_u - half_v, half_u * 2, half_v * 2, {5, 5, 5}});
  }
  Vec3 centre{-30_mm, 0, -0.27}, half_u{0, 12_mm, 0}, half_v = Vec3{6, 0, 6} * 1e-3;  // edge_u × edge_v to the wall
};

/// Direct light of the lamp by directions that the BSDF draws.
Statistics by_surface(const LampScene& lamp, int count) {
  Scene scene = lamp.scene;
  scene.lights.clear();
  scene.meshes.resize(1);
  LampScene met = lamp;
  met.scene = scene;
  met.add_mesh_lamp();
  const Accelerator accelerator(met.scene);
  const auto hit = accelerator.closest_hit(lamp.ray);
  const Bsdf bsdf = make_bsdf(met.scene.materials[0], hit->point, Lines{});
  Statistics statistics;
  for (int i = 0; i < count; ++i) {
    CounterRandom random(5, 0, uint64_t(i));
    const double u = random.uniform(), v = random.uniform(), w = random.uniform();
    const auto next = sample_bsdf(bsdf, -lamp.ray.direction, u, {v, w});
    double light = 0;
    if (next) {
      const auto met_lamp = accelerator.closest_hit({accelerator.leave(hit->point, next->direction), next->direction});
      if (met_lamp && met_lamp->point.material == 1) light = next->weight.y * 5;
    }
    statistics.add(light);
  }
  return statistics;
}

/// Direct light of the lamp by places evenly over it.
Statistics by_lamp(const LampScene& lamp, int count) {
  const Accelerator accelerator(lamp.scene);
  const auto hit = accelerator.closest_hit(lamp.ray);
  const Bsdf bsdf = make_bsdf(lamp.scene.materials[0], hit->point, Lines{});
  Statistics statistics;
  for (int i = 0; i < count; ++i) {
    CounterRandom random(6, 0, uint64_t(i));
    const double u = 2 * random.uniform() - 1, v = 2 * random.uniform() - 1;
    const Vec3 way = lamp.centre + lamp.half_u * u + lamp.half_v * v - hit->point.position;
    const Vec3 direction = normalize(way), area = cross(lamp.half_u, lamp.half_v) * 4;
    const Vec3 f = eval_bsdf(bsdf, -lamp.ray.direction, direction, Lobe::diffuse) +
                   eval_bsdf(bsdf, -lamp.ray.direction, direction, Lobe::glossy);
    statistics.add(f.y * 5 * std::abs(dot(area, direction)) / dot(way, way));
  }
  return statistics;
}

TEST(Integrator, AskingMeetingAndBothTogetherFindTheSameLight) {
  const std::vector<Material> materials = {
      grey(0.6), ConductorMaterial{metal_index("Ag"), 0.3}, ConductorMaterial{metal_index("Ag"), 0.8},
      MetallicRoughnessMaterial{.base_color = {0.5, 0.5, 0.5}, .metallic = 0, .roughness = 0.3}};
  constexpr int count = 60000;
  for (const Material& material : materials) {
    LampScene mesh(material), rectangle(material);
    mesh.add_mesh_lamp();
    rectangle.add_rectangle_lamp();
    const Statistics met = by_surface(mesh, count), asked = by_lamp(mesh, count);
    const Statistics both_mesh = follow(mesh.scene, mesh.ray, count, 2);
    const Statistics both_rectangle = follow(rectangle.scene, rectangle.ray, count, 1);
    const auto expect_same = [](const Statistics& a, const Statistics& b) {
      EXPECT_NEAR(a.mean(), b.mean(), 4 * std::hypot(a.standard_error(), b.standard_error()));
    };
    expect_same(met, asked);
    expect_same(met, both_mesh);
    expect_same(asked, both_mesh);
    expect_same(met, both_rectangle);
    expect_same(asked, both_rectangle);
    expect_same(both_mesh, both_rectangle);
    // Veach's bound for the balance heuristic, doubled for the power heuristic and roulette: near the better of both.
    const double better = std::min(met.standard_error(), asked.standard_error());
    EXPECT_LT(both_mesh.standard_error(), 2 * better);
    EXPECT_GT(both_mesh.mean(), 0.01);
  }
}

TEST(Integrator, ARoughMetalUnderAnEnvironmentIsTheSameAskedAndMet) {
  // The same sky as a map, which is asked and met, and as four times finer sums over all directions.
  auto map = std::make_shared<Image>(16, 32, 1);
  CounterRandom random(3, 0, 0);
  for (float& value : map->values) value = float(std::pow(random.uniform(), 3));
  for (const double roughness : {0.4, 0.9}) {
    LampScene lamp(Material(ConductorMaterial{metal_index("Al"), roughness}));
    lamp.scene.environment = {map, {3, 3, 3}, 0.3};
    const EnvironmentLight light(*lamp.scene.environment, Lines{});
    const PathScene path_scene(lamp.scene, Lines{}, {}, {});
    const PathStart start = start_of(path_scene, lamp.ray);
    const Bsdf bsdf = make_bsdf(lamp.scene.materials[0], start.point, Lines{});
    double integral = 0;
    constexpr int rows = 800, columns = 1600;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        const Vec3 d = environment_direction({(i + 0.5) / columns, (j + 0.5) / rows}, 0.3);
        if (d.z > 0)
          integral += eval_bsdf(bsdf, start.outgoing, d, Lobe::glossy).y * light.radiance(d).y *
                      std::sin(pi * (j + 0.5) / rows) * (2 * pi * pi / (double(columns) * rows));
      }
    const Statistics found = follow(lamp.scene, lamp.ray, 40000, 1);
    EXPECT_NEAR(found.mean(), integral, 4 * found.standard_error() + 1e-3 * integral);  // midpoints in a lobe of 9°
  }
}

// --- closed forms with many bounces ---

TEST(Integrator, ABallThatShinesInAHollowSphereHasItsClosedForm) {
  constexpr double rho = 0.7, ratio = 0.4;
  Scene scene;
  scene.materials = {grey(rho), grey(0, 3)};
  scene.meshes = {make_round_mesh({0, 0, -0.3}, 20_mm, 64), make_round_mesh({0, 0, -0.3}, ratio * 20_mm, 64)};
  scene.meshes[1].material = 1;
  // Of what leaves a place of the shell, f = (r/R)² falls on the ball: L = ρ·(f·L₀ + (1 − f)·L).
  constexpr double f = ratio * ratio, expected = rho * f * 3 / (1 - rho * (1 - f));
  PathCounts counts;
  const Statistics found = follow(scene, {{15_mm, 1_mm, -0.3}, normalize({1, 0.2, 0.1})}, 20000, unlimited, counts);
  // Facets of 2.8° stand in for spheres: areas short by some (π/128)², 6e-4.
  EXPECT_NEAR(found.mean(), expected, 4 * found.standard_error() + 2e-3 * expected);
  EXPECT_EQ(counts.escaped, 0);
}

TEST(Integrator, TwoDiffusePlatesReflectEachOtherAsTheSeriesSays) {
  // Wide plates at a short distance c: what leaves at the edges is (c/a)² of all, 1e-5. L₂ = ρ₂·L₀/(1 − ρ₁ρ₂).
  constexpr double first = 0.8, second = 0.5;
  Scene scene;
  scene.materials = {grey(first, 2), grey(second)};
  scene.meshes = {make_wall(-0.300, 0.3, 0.3), make_wall(-0.301, 0.3, 0.3, 1)};
  const Ray ray{{0, 0, -0.3005}, {0, 0, -1}};
  const Statistics found = follow(scene, ray, 40000, unlimited);
  EXPECT_NEAR(found.mean(), second * 2 / (1 - first * second), 4 * found.standard_error() + 1e-4);
  // Bounce by bounce: with n surfaces at most, the terms of the series that have as many.
  double sum = 0, term = second * 2;
  for (const int surfaces : {2, 4, 6}) {
    sum += term;
    term *= first * second;
    const Statistics part = follow(scene, ray, 40000, surfaces);
    EXPECT_NEAR(part.mean(), sum, 4 * part.standard_error() + 1e-4) << surfaces;
  }
}

TEST(Integrator, ErrorsFallAtLeastAsTheRootOfThePaths) {
  LampScene lamp(grey(0.6));
  lamp.add_mesh_lamp();
  const PathScene path_scene(lamp.scene, Lines{}, {}, {});
  const PathStart start = start_of(path_scene, lamp.ray);
  const auto deviation = [&](int paths) {
    Statistics statistics;
    PathCounts counts;
    for (uint64_t sample = 0; sample < 400; ++sample) {
      Vec3 sum;
      mean_radiance(path_scene, start, paths, sample, {&sum, 1}, counts);
      statistics.add(sum.y);
    }
    return statistics.standard_error();
  };
  // 400 samples know a deviation to 1/√800 = 3.5 %, the ratio of two to 5 %: 4 of those.
  EXPECT_LT(deviation(256), deviation(16) / 4 * 1.2);
}

TEST(Integrator, AMirrorOfFullWeightNeverEndsAPath) {
  // Between two mirrors that reflect all but 4e-12 (n → 0), only max_depth ends a path.
  Scene scene;
  scene.materials = {{ConductorMaterial{{{{500e-9, 1e-12, 1}}}, 0}}};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm), make_wall(-0.31, 10_mm, 10_mm)};
  PathCounts counts;
  follow(scene, {{0, 0, -0.305}, {0, 0, -1}}, 1000, 50, counts);
  EXPECT_EQ(counts.vertices, 50 * 1000);
  EXPECT_EQ(counts.cut, 1000);
}

// --- path expressions ---

/// A room with everything: diffuse, glossy and mirror surfaces, lamps of every kind and a sky.
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

TEST(PathLayers, OfAPartitionAddUpToTheWhole) {
  const std::vector<std::string> parts = {"EL", "E(D|G)L", "ESL", "ED.+L", "EG.+L", "ES(D|G)L", "ESS.*L", "ES(D|G).+L"};
  for (const Ray& ray : rich_rays) {
    const double whole = sums_of(rich_scene(), ray, {}, {}, 2000)[0];
    double sum = 0;
    for (const double part : sums_of(rich_scene(), ray, parts, {}, 2000)) sum += part;
    EXPECT_GT(whole, 0.01);
    EXPECT_NEAR(sum / whole, 1, 1e-6);
  }
}

TEST(PathLayers, OfSeparateLightsAddUpToTheWhole) {
  for (const Ray& ray : rich_rays) {
    const double whole = sums_of(rich_scene(), ray, {}, {}, 2000)[0];
    const std::vector<double> lights = sums_of(rich_scene(), ray, {}, {.separate_lights = true}, 2000);
    ASSERT_EQ(lights.size(), 6U) << "four lights, emission, background";
    double sum = 0;
    for (const double light : lights) sum += light;
    EXPECT_NEAR(sum / whole, 1, 1e-12);
    // And each is what the scene with that light alone has.
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

TEST(PathLayers, RayCastingIsTheDirectLightAlone) {
  Scene scene = rich_scene();
  scene.lights = {scene.lights[0]};
  scene.environment.reset();
  scene.background = {};
  scene.materials[3].emission = {};
  const Ray& ray = rich_rays[0];
  // One point light: nothing is random in the direct light, and with one surface there is no other.
  const double direct = sums_of(scene, ray, {}, {.max_depth = 1}, 1)[0];
  EXPECT_GT(direct, 0);
  EXPECT_NEAR(sums_of(scene, ray, {"E(D|G)L"}, {}, 100)[0], direct, 1e-12 * direct);
  EXPECT_GT(sums_of(scene, ray, {"E.*L"}, {}, 100)[0], 1.001 * direct);
}

TEST(PathLayers, RadiosityIsAllOfADiffuseSceneAndNothingOfAMirror) {
  Scene room = make_box_scene({0, 0, -0.3}, {10_mm, 8_mm, 6_mm}, grey(0.5, 1));
  const Ray ray{{1_mm, 1_mm, -0.3}, normalize({0.3, -0.5, 0.2})};
  EXPECT_NEAR(sums_of(room, ray, {"ED*L"}, {}, 500)[0], sums_of(room, ray, {}, {}, 500)[0], 1e-12);
  EXPECT_EQ(sums_of(rich_scene(), rich_rays[1], {"ED*L"}, {}, 500)[0], 0) << "the mirror is the first surface";
}

TEST(PathLayers, RecursiveRayTracingSeesTheWallInTheMirrorByItsReflectance) {
  // The mirror stands at 45° on the axis; the wall that it shows lies 30 mm to the left, lit from 20 mm before it.
  Scene scene;
  scene.materials = {grey(0.6), {ConductorMaterial{constant_index(3), 0}}};
  scene.meshes = {make_test_quad({0, 0, -0.3}, normalize({1, 0, 1}) * 10_mm, {0, 10_mm, 0}, 1),
                  make_test_quad({-30_mm, 0, -0.3}, {0, 0, 10_mm}, {0, 10_mm, 0})};
  scene.lights = {PointLight{{-10_mm, 0, -0.28}, {1, 1, 1}}};
  const Ray ray{{0, 0, 0}, {0, 0, -1}};
  const double wall = 0.6 / pi * (20 / std::sqrt(800.0)) / 800e-6;
  // Fresnel at 45°, n = 3: the mean of s and p.
  const double c = std::sqrt(0.5), t = std::sqrt(1 - 0.5 / 9);
  const double s = std::pow((c - 3 * t) / (c + 3 * t), 2), p = std::pow((3 * c - t) / (3 * c + t), 2);
  const double reflectance = (s + p) / 2, expected = reflectance * wall;
  constexpr int paths = 40000;
  // A path of one in 1/R sees the wall.
  const double error = 4 * wall * std::sqrt(reflectance * (1 - reflectance) / paths);
  EXPECT_NEAR(sums_of(scene, ray, {"ES*(D|G)L"}, {}, paths)[0], expected, error);
  EXPECT_EQ(sums_of(scene, ray, {"ED*L"}, {}, 1000)[0], 0);
  EXPECT_EQ(sums_of(scene, ray, {"ESSDL"}, {}, 1000)[0], 0);
}

TEST(PathLayers, PathsThatNoLayerTakesEndAtOnce) {
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

// --- clamp ---

TEST(Clamp, HoldsEveryPathAndCountsIt) {
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.lights = {PointLight{{0, 0, -0.26}, {1, 2, 3}}, PointLight{{0, 0, -0.26}, {1, 2, 3}}};
  const Ray ray{{0, 0, 0}, {0, 0, -1}};
  const double all = sums_of(scene, ray, {}, {}, 10)[0];
  EXPECT_EQ(sums_of(scene, ray, {}, {.clamp = 2 * all}, 10)[0], all) << "no path reaches it";
  EXPECT_NEAR(sums_of(scene, ray, {}, {.clamp = all / 4}, 10)[0], all / 4, 1e-12 * all);
  // Sums of their own share what is let through.
  const std::vector<double> lights = sums_of(scene, ray, {}, {.clamp = all / 4, .separate_lights = true}, 10);
  EXPECT_NEAR(lights[0], all / 8, 1e-12 * all);
  EXPECT_NEAR(lights[1], all / 8, 1e-12 * all);
  PathCounts counts;
  const PathScene path_scene(scene, Lines{}, {}, {.clamp = all});  // green stays, blue does not
  Vec3 sum;
  mean_radiance(path_scene, start_of(path_scene, ray), 10, 0, {&sum, 1}, counts);
  EXPECT_EQ(counts.clamped, 10);
  EXPECT_NEAR(sum.x, all / 2, 1e-12 * all);
  EXPECT_NEAR(sum.z, all, 1e-12 * all);
  EXPECT_EQ(error_of([&] { PathScene(scene, Lines{}, {}, {.clamp = -1}); }),
            "expected a clamp of 0 W/m²/sr or more, got -1");
}

// --- lasers ---

Phasors phasors_of(const Scene& scene, const Ray& ray, int paths, int max_depth, const Lines& lines = {},
                   uint64_t sample = 0) {
  const PathScene path_scene(scene, lines, {}, {.max_depth = max_depth});
  std::vector<Phasors> sums(size_t(path_scene.sums()));
  PathCounts counts;
  laser_phasors(path_scene, start_of(path_scene, ray), paths, sample, sums, counts);
  return sums[0];
}

/// How far two phases [rad] are apart.
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
    // 0.05 m are 1e5 cycles: 1e-15 of them, times 2π, and the place of the wall to 1e-17 m.
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
  // One face of glass at z = −0.3; 10 mm inside lies a wall, and 6 mm before that the laser.
  Scene scene;
  scene.materials = {grey(0.6), {DielectricMaterial{constant_index(1.5), 0}}};
  scene.meshes = {make_wall(-0.31, 10_mm, 10_mm), make_wall(-0.3, 10_mm, 10_mm, 1)};
  scene.lights = {PointLight{{0, 0, -0.304}, {1, 1, 1}, true}};
  const Ray ray{{1_mm, 0, 0}, {0, 0, -1}};
  const Phasors u = phasors_of(scene, ray, 64, 2);
  const double path = 1.5 * (std::hypot(1_mm, 6_mm) + 10_mm);
  EXPECT_LT(phase_difference(std::arg(u[1]), 2 * pi * (path / green_line)), 1e-8);
  // Paths that the face lets through are all alike: their mean is the radiance, no speckle.
  const double mean = sums_of(scene, ray, {}, {.max_depth = 2}, 64)[0];
  EXPECT_GT(mean, 0);
  EXPECT_NEAR(std::norm(u[1]) / mean, 1, 1e-9);
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

// --- roulette ---

TEST(Roulette, TakesNoPathForTheRadianceScaleOfGlass) {
  // A shining wall through a slab: of normal light (1 − R)² ≈ 0.92 comes through one way, the rest by ways between the
  // faces or not at all. Chosen by share, paths spread by √(p(1 − p)) ≈ 0.27; roulette of the n² = 2.25 that radiance
  // gains and loses would take 5 of 9 paths and make them spread by 1.
  Scene scene;
  scene.materials = {grey(0, 1), {DielectricMaterial{}}};
  Mesh slab = make_box({20_mm, 20_mm, 2_mm});
  for (Vec3& p : slab.positions) p = p + Vec3{0, 0, -0.28};
  slab.material = 1;
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm), slab};
  const Statistics found = follow(scene, {{0, 0, 0}, {0, 0, -1}}, 4000, 16);
  EXPECT_NEAR(found.mean(), 0.92, 0.03);  // 4 of 0.27/√4000, and what comes after more than two faces
  EXPECT_LT(found.standard_error() * std::sqrt(4000.0), 0.4);
}

}  // namespace
}  // namespace holotrace
