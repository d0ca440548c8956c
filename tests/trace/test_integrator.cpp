#include <gtest/gtest.h>

#include <complex>

#include "holotrace/base/random.h"
#include "holotrace/data/shapes.h"
#include "holotrace/trace/lights/emitters.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/materials/fresnel.h"
#include "trace/follow.h"

namespace holotrace {
namespace {

// --- the techniques of finding light agree ---

/// A surface of that material in front of the panel, seen at 45°, and a lamp above it.
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

/// Direct light of the lamp, from directions that the BSDF draws.
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

/// Direct light of the lamp, from places uniform over it.
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
    // Veach's bound for the balance heuristic, doubled for the power heuristic and roulette: near the better technique.
    const double better = std::min(met.standard_error(), asked.standard_error());
    EXPECT_LT(both_mesh.standard_error(), 2 * better);
    EXPECT_GT(both_mesh.mean(), 0.01);
  }
}

TEST(Integrator, ARoughMetalUnderAnEnvironmentIsTheSameAskedAndMet) {
  // The same sky as a map, which is both sampled and met, compared with four times finer sums over all directions.
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
    EXPECT_NEAR(found.mean(), integral, 4 * found.standard_error() + 1e-3 * integral);  // midpoint rule in a lobe of 9°
  }
}

// --- closed forms with many bounces ---

TEST(Integrator, ABallThatShinesInAHollowSphereHasItsClosedForm) {
  constexpr double rho = 0.7, ratio = 0.4;
  Scene scene;
  scene.materials = {grey(rho), grey(0, 3)};
  scene.meshes = {make_round_mesh({0, 0, -0.3}, 20_mm, 64), make_round_mesh({0, 0, -0.3}, ratio * 20_mm, 64)};
  scene.meshes[1].material = 1;
  // Of the light that leaves a place of the shell, f = (r/R)² falls on the ball: L = ρ·(f·L₀ + (1 − f)·L).
  constexpr double f = ratio * ratio, expected = rho * f * 3 / (1 - rho * (1 - f));
  PathCounts counts;
  const Statistics found = follow(scene, {{15_mm, 1_mm, -0.3}, normalize({1, 0.2, 0.1})}, 20000, unlimited, counts);
  // Facets of 2.8° replace spheres: areas are too small by some (π/128)², 6e-4.
  EXPECT_NEAR(found.mean(), expected, 4 * found.standard_error() + 2e-3 * expected);
  EXPECT_EQ(counts.escaped, 0);
}

TEST(Integrator, TwoDiffusePlatesReflectEachOtherAsTheSeriesSays) {
  // Wide plates at a short distance c: the light lost at the edges is (c/a)² of all, 1e-5. L₂ = ρ₂·L₀/(1 − ρ₁ρ₂).
  constexpr double first = 0.8, second = 0.5;
  Scene scene;
  scene.materials = {grey(first, 2), grey(second)};
  scene.meshes = {make_wall(-0.300, 0.3, 0.3), make_wall(-0.301, 0.3, 0.3, 1)};
  const Ray ray{{0, 0, -0.3005}, {0, 0, -1}};
  const Statistics found = follow(scene, ray, 40000, unlimited);
  EXPECT_NEAR(found.mean(), second * 2 / (1 - first * second), 4 * found.standard_error() + 1e-4);
  // Bounce by bounce: with at most n surfaces, the terms of the series with at most n surfaces.
  double sum = 0, term = second * 2;
  for (const int surfaces : {2, 4, 6}) {
    sum += term;
    term *= first * second;
    const Statistics part = follow(scene, ray, 40000, surfaces);
    EXPECT_NEAR(part.mean(), sum, 4 * part.standard_error() + 1e-4) << surfaces;
  }
}

/// Gauss–Legendre points in [0, 1] (Newton's method on the Legendre polynomial) and their weights.
std::vector<Vec2> gauss_points(int count) {
  std::vector<Vec2> points;
  for (int i = 0; i < count; ++i) {
    double z = std::cos(pi * (i + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 20; ++step) {
      double p = 1, before = 0;
      for (int j = 0; j < count; ++j) {
        const double next = ((2 * j + 1) * z * p - j * before) / (j + 1);
        before = p, p = next;
      }
      slope = count * (z * p - before) / (z * z - 1);
      z -= p / slope;
    }
    points.push_back({(1 + z) / 2, 1 / ((1 - z * z) * slope * slope)});
  }
  return points;
}

// Between two emitting plates of L₀ = 1, light leaves and meets surfaces at one angle θ, µ = cosθ:
//
//     L(µ) = L₀ + ∫₀¹ K(µ, µ')·L(µ') dµ',   K = ∫ f(µ, µ', φ)·µ' dφ
//
// solved here at Gauss points, which use only f of the material: no sampling, no weights, no roulette. A path has 1/(1
// − 0.9) = 10 surfaces or so; a wrong weight of roulette would show at each of them.
TEST(Integrator, PathsBetweenRoughMetalPlatesHaveTheLightOfTheIntegralEquation) {
  for (const double roughness : {0.5, 1.0}) {
    Material metal(MetallicRoughnessMaterial{.base_color = {0.9, 0.9, 0.9}, .metallic = 1, .roughness = roughness});
    metal.emission = {1, 1, 1};
    Scene scene;
    scene.materials = {metal};
    const double gap = 10_mm, side = 20;  // light lost at the sides, µ below 1/2000, is 1/2000²
    scene.meshes = {make_wall(-0.3, side, side), make_test_quad({0, 0, -0.3 + gap}, {0, side, 0}, {side, 0, 0})};
    const double mu = 0.8;
    const auto direction = [](double cosine, double angle) {
      const double sine = std::sqrt(1 - cosine * cosine);
      return Vec3{sine * std::cos(angle), sine * std::sin(angle), cosine};
    };
    const Ray ray{{0, 0, -0.3 + gap / 2}, -direction(mu, 0)};
    const PathScene path_scene(scene, Lines{}, {}, {});
    const Bsdf bsdf = make_bsdf(metal, start_of(path_scene, ray).point, Lines{});
    const std::vector<Vec2> points = gauss_points(24);
    constexpr int turns = 60;  // steps of φ over half a turn, closer at the mirror direction: φ = π − π·t³
    const auto kernel = [&](double from, const Vec2& to) {
      double sum = 0;
      for (int k = 0; k < turns; ++k) {
        const double t = (k + 0.5) / turns;
        sum += 3 * t * t * eval_bsdf(bsdf, direction(from, 0), direction(to.x, pi - pi * t * t * t), Lobe::glossy).y;
      }
      return sum * 2 * pi / turns * to.y;
    };
    std::vector<double> light(points.size(), 1.0), rows;
    for (const Vec2& from : points)
      for (const Vec2& to : points) rows.push_back(kernel(from.x, to));
    const auto gathered = [&](const auto& weight_of) {
      double sum = 1;
      for (size_t j = 0; j < points.size(); ++j) sum += weight_of(j) * light[j];
      return sum;
    };
    for (int order = 0; order < 300; ++order) {  // 0.9³⁰⁰ = 2e-14
      std::vector<double> next;
      for (size_t i = 0; i < points.size(); ++i)
        next.push_back(gathered([&](size_t j) { return rows[i * points.size() + j]; }));
      light = next;
    }
    const double expected = gathered([&](size_t j) { return kernel(mu, points[j]); });
    const Statistics found = follow(scene, ray, 60000, unlimited);
    // Four times as many points change `expected` by 2e-4.
    EXPECT_NEAR(found.mean() / expected, 1, 4 * found.standard_error() / expected + 2e-4) << roughness;
    EXPECT_LT(found.standard_error(), 0.005 * expected) << "else the line above claims little";
  }
}

TEST(Integrator, AskingTheLampAtTheEndOfAPathFindsTheLightOfDirectPaths) {
  // One wall under a point light: ρ/π·I·cosθ/d², whatever fraction of the paths continues (and finds nothing).
  Scene scene;
  scene.materials = {grey(0.6)};
  scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
  scene.lights = {PointLight{{30_mm, 0, -0.26}, {1, 1, 1}}};
  PathCounts counts;
  const Statistics light = follow(scene, {{}, {0, 0, -1}}, 20000, {.max_depth = 4, .asks_at_end = true}, counts);
  const double expected = 0.6 / pi * 0.8 / (0.05 * 0.05);
  EXPECT_NEAR(light.mean() / expected, 1, 4 * light.standard_error() / expected);
  // Roulette ends 0.4 of the paths at the wall, and only these sample the light; 4 standard errors of a binomial.
  EXPECT_NEAR(double(counts.shadow_rays) / 20000, 0.4, 4 * std::sqrt(0.4 * 0.6 / 20000));
}

TEST(Integrator, AskingAtTheEndOfAPathFindsTheSameLightInFewerShadowRays) {
  // A point light in a box, whose walls reflect; a lamp with an area over two walls, which paths also meet; and a rough
  // metal under this lamp. Each to 4 standard errors of both means.
  Scene box = make_box_scene({0, 0, -0.3}, {10_mm, 8_mm, 6_mm}, grey(0.8));
  box.lights = {PointLight{{2_mm, 3_mm, -0.302}, {1e-4, 1e-4, 1e-4}}};
  Scene metal = make_corner();
  metal.materials[0] = ConductorMaterial{.roughness = 0.5};
  metal.lights = {RectangleLight{{-30_mm, 30_mm, -0.31}, {60_mm, 0, 0}, {0, 0, 60_mm}, {4, 4, 4}}};
  const std::pair<Scene, Ray> cases[] = {{box, {{1_mm, 1_mm, -0.3}, normalize({0.3, -0.5, 0.2})}},
                                         {make_corner(), {{}, normalize({0, -4_mm, -0.3})}},
                                         {metal, {{}, normalize({0, -4_mm, -0.3})}}};
  for (const auto& [scene, ray] : cases)
    for (const int max_depth : {3, 20}) {
      PathCounts everywhere, at_end;
      const Statistics expected = follow(scene, ray, 40000, max_depth, everywhere);
      const Statistics found = follow(scene, ray, 40000, {.max_depth = max_depth, .asks_at_end = true}, at_end);
      EXPECT_GT(expected.mean(), 0);
      EXPECT_NEAR(found.mean(), expected.mean(), 4 * std::hypot(found.standard_error(), expected.standard_error()));
      EXPECT_LE(at_end.shadow_rays, at_end.paths) << "one light, asked once at most";
      EXPECT_LT(at_end.shadow_rays, everywhere.shadow_rays);
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
  // 400 samples give a deviation to 1/√800 = 3.5 %, and the ratio of two to 5 %: 4 times that.
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
  // Separate sums share the light that the clamp keeps.
  const std::vector<double> lights = sums_of(scene, ray, {}, {.clamp = all / 4, .separate_lights = true}, 10);
  EXPECT_NEAR(lights[0], all / 8, 1e-12 * all);
  EXPECT_NEAR(lights[1], all / 8, 1e-12 * all);
  PathCounts counts;
  const PathScene path_scene(scene, Lines{}, {}, {.clamp = all});  // green is not clamped, blue is
  Vec3 sum;
  mean_radiance(path_scene, start_of(path_scene, ray), 10, 0, {&sum, 1}, counts);
  EXPECT_EQ(counts.clamped, 10);
  EXPECT_NEAR(sum.x, all / 2, 1e-12 * all);
  EXPECT_NEAR(sum.z, all, 1e-12 * all);
  EXPECT_EQ(error_of([&] { PathScene(scene, Lines{}, {}, {.clamp = -1}); }),
            "expected a clamp of 0 W/m²/sr or more, got -1");
}

}  // namespace
}  // namespace holotrace
