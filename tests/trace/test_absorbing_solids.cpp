#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "holotrace/data/shapes.h"
#include "holotrace/trace/trace.h"
#include "trace/follow.h"

// Solids and media dim light on all its ways: seen through them, from lamps in them and behind them, by mirrors and as caustics.
// The expected share is exp(−σ·d), d being the length of the way in them.

namespace holotrace {
namespace {

const Vec3 colour_after{0.5, 0.25, 1};  // of white light after 0.1 m
constexpr double wall_z = -0.3;

Vec3 share_after(double distance) {
  return {std::pow(colour_after.x, distance / 0.1), std::pow(colour_after.y, distance / 0.1), 1};
}

Material absorbing(double index, bool absorbs) {
  PrincipledMaterial solid{.base_color = {{1, 1, 1}}, .roughness = {0}, .index = constant_index(index)};
  solid.transmission.value = 1;
  if (absorbs) {
    solid.attenuation_color = colour_after;
    solid.attenuation_distance = 0.1;
  }
  return solid;
}

/// Adds a box of the last material from z = low to z = high.
void add_block(Scene& scene, double low, double high) {
  Mesh block = make_box({0.6, 0.6, high - low});
  for (Vec3& p : block.positions) p.z += (low + high) / 2;
  block.material = int(scene.materials.size()) - 1;
  scene.meshes.push_back(block);
}

/// A grey wall at z = −0.3 m; a block of this index from z = low to z = high.
Scene wall_and_block(double low, double high, double index, bool absorbs) {
  Scene scene;
  scene.materials = {grey(0.5), absorbing(index, absorbs)};
  scene.meshes = {make_wall(wall_z, 0.1, 0.1)};
  add_block(scene, low, high);
  return scene;
}

struct Look {
  int rays = 1, paths = 256;  ///< of each ray
  double z = -0.001;          ///< at which rays start [m]
  int max_depth = 5;          ///< also of caustics, which take long to find
};

/// The mean of light seen along −z by rays in a square of 1 mm. Media are the same for the same ray, so that they need many rays.
Vec3 light_seen(const Scene& scene, const std::string& group = "E.*L", Look look = {}) {
  const PathScene path_scene(scene, Lines{}, {group}, {.max_depth = look.max_depth, .roulette_depth = look.max_depth});
  Vec3 sum;
  PathCounts counts;
  CounterRandom random(1, 0, 0);
  for (int i = 0; i < look.rays; ++i) {
    // Not through an edge between the triangles of a block.
    const double u = look.rays > 1 ? random.uniform() : 0, v = look.rays > 1 ? random.uniform() : 0;
    const Ray ray{{0.0013 + 1e-3 * u, 0.0007 - 1e-3 * v, look.z}, {0, 0, -1}};
    const auto hit = path_scene.accelerator.closest_hit(ray);
    EXPECT_TRUE(hit.has_value());
    Vec3 mean;
    mean_radiance(path_scene, {hit->point, -ray.direction, path_scene.automaton.start(), 1}, look.paths, uint64_t(i),
                  {&mean, 1}, counts);
    sum += mean * hit->weight / look.rays;
  }
  return sum;
}

void expect_share(Vec3 with, Vec3 without, Vec3 share, double tolerance) {
  EXPECT_GT(without.x, 0);
  EXPECT_NEAR(with.x / without.x / share.x, 1, tolerance);
  EXPECT_NEAR(with.y / without.y / share.y, 1, tolerance);
  EXPECT_NEAR(with.z / without.z / share.z, 1, tolerance);
}

// The wall lies in the block, 0.2 m behind its face. Lamps in the block and before it are at heights of 0.1 and 0.29 m over the wall, and
// so narrow that slanted ways are longer by less than 1e-4 of them. With an index of 1 nothing is reflected. Lamps of no area have no
// noise; a rectangle is sampled by the same numbers in both scenes.
TEST(AbsorbingSolids, DimLampsInThemAndBehindThem) {
  for (const double height : {0.1, 0.29}) {
    const double in_block = std::min(height, 0.2);
    const Vec3 at{0.001, 0, wall_z + height};
    std::vector<Light> lights{
        PointLight{at, {1, 1, 1}}, SpotLight{at, {0, 0, -1}, {1, 1, 1}, 0.1, 0.2},
        RectangleLight{at, {0, 1e-3, 0}, {1e-3, 0, 0}, {1e6, 1e6, 1e6}, false},
        RectangleLight{at + Vec3{0.003, 0, 0}, {0, 1e-3, 0}, {1e-3, 0, 0}, {1e6, 1e6, 1e6}, true}};
    if (height > 0.2) lights.emplace_back(DirectionalLight{{0, 0, -1}, {1, 1, 1}});
    for (size_t i = 0; i < lights.size(); ++i) {
      SCOPED_TRACE(testing::Message() << "lamp " << i << " at the height " << height);
      Scene with = wall_and_block(-0.5, -0.1, 1, true), without = wall_and_block(-0.5, -0.1, 1, false);
      with.lights = without.lights = {lights[i]};
      expect_share(light_seen(with), light_seen(without), share_after(0.2 + in_block), 1e-3);
    }
  }
}

// Rays of a camera and waves see an emitting wall in the block and behind one: bright, times the way in the block.
TEST(AbsorbingSolids, DimWhatIsSeenInThemAndThroughThem) {
  for (const auto& [low, high, inside] : {std::tuple{-0.5, -0.1, 0.2}, {-0.25, -0.1, 0.15}}) {
    Scene scene = wall_and_block(low, high, 1, true);
    scene.materials[0] = grey(0, 1);
    expect_share(light_seen(scene), {1, 1, 1}, share_after(inside), 2e-5);  // rays start off surfaces
    for (const SourcePhase phase : {SourcePhase::random, SourcePhase::path}) {
      TraceParams params{.columns = 4, .rows = 4, .paths = 1, .phase = phase};
      params.field_of_view = 0.01;  // cosines are 1 up to 5e-5, squared amplitudes to 2e-4
      const Grid panel{64, 64, 8e-6};
      Scene clear = wall_and_block(low, high, 1, false);
      clear.materials[0] = grey(0, 1);
      const auto power = [&](const Scene& of) {
        double sum = 0;
        for (const Source& wave : trace(of, panel, red_line, params).waves)
          sum += double(wave.amplitude) * double(wave.amplitude);
        return sum;
      };
      EXPECT_NEAR(power(scene) / power(clear) / share_after(inside).x, 1, 1e-3);
    }
  }
}

// A mirror in the block, at the height 0.15 m over the wall and beside it, shows lamps that stand in the block, too.
TEST(AbsorbingSolids, DimTheWayByAMirror) {
  const auto scene_by = [](const Light& light, bool absorbs) {
    Scene scene = wall_and_block(-0.5, -0.1, 1, absorbs);
    scene.materials.emplace_back(ConductorMaterial{.index = constant_index(1e-6)});
    scene.meshes.push_back(make_test_quad({-0.05, 0, wall_z + 0.075}, {0, 0.05, 0}, {0, 0, 0.07}, 2));
    scene.lights = {light};
    return scene;
  };
  const Vec3 lamp{0, 0, wall_z + 0.1}, image{-0.1, 0, wall_z + 0.1}, seen{0.0013, 0.0007, wall_z};
  const Light point = PointLight{lamp, {1, 1, 1}};
  expect_share(light_seen(scene_by(point, true), "ESDSL"), light_seen(scene_by(point, false), "ESDSL"),
               share_after(0.2 + length(image - seen)), 1e-4);
  // From places of a lamp of 1 mm the way differs by up to 0.4 %, as does the light: 0.003 of an exponent of 4.8.
  const Light square = RectangleLight{lamp, {0, 1e-3, 0}, {1e-3, 0, 0}, {1e6, 1e6, 1e6}, false};
  const Vec3 with = light_seen(scene_by(square, true), "ESD.*L"),
             without = light_seen(scene_by(square, false), "ESD.*L");
  EXPECT_GT(without.y, 0);
  EXPECT_LT(with.y / without.y, share_after(0.3).y * 1.01);
  EXPECT_GT(with.y / without.y, share_after(0.2 + length(image - seen)).y * 0.99);
}

// A slab in a furnace, seen head-on: of the light that enters, a passes on each way through. With R = ((n − 1)/(n + 1))² it reflects
// R + (1 − R)²·R·a²/(1 − R²·a²) and transmits (1 − R)²·a/(1 − R²·a²). Paths choose at random: 4 standard errors of 4 % at 256·64 paths.
TEST(AbsorbingSolids, ASlabInAFurnaceHasItsTransmittanceAndReflectance) {
  Scene scene;
  scene.materials = {absorbing(1.5, true)};
  add_block(scene, -0.15, -0.1);
  scene.background = {1, 1, 1};
  const double reflected = 0.04;
  const auto expected = [&](double a) {
    const double rest = (1 - reflected) * (1 - reflected) / (1 - reflected * reflected * a * a);
    return reflected + rest * reflected * a * a + rest * a;
  };
  const Vec3 seen = light_seen(scene, "E.*L", {.paths = 16384, .max_depth = 20}), share = share_after(0.05);
  EXPECT_NEAR(seen.x, expected(share.x), 2e-3);
  EXPECT_NEAR(seen.y, expected(share.y), 2e-3);
  EXPECT_NEAR(seen.z, 1, 1e-3);  // paths longer than max_depth
}

// A medium in a solid takes the place of its attenuation; what a mesh with a hole encloses ends at its last face.
TEST(AbsorbingSolids, EndAtMediaAndAtTheirLastFace) {
  Scene scene;
  scene.materials = {absorbing(1, true)};
  add_block(scene, -0.3, -0.1);
  const Ray ray{{0.0013, 0.0007, 0}, {0, 0, -1}};
  EXPECT_NEAR(Accelerator(scene).transmittance(ray, 1).x, share_after(0.2).x, 1e-6);
  Medium& medium = scene.media.emplace_back();
  medium.extinction = {1, 1, 1};
  scene.materials.emplace_back(ScatteringMaterial{});
  medium.material = 1;
  scene.materials[0].medium = 0;
  EXPECT_NEAR(Accelerator(scene).transmittance(ray, 1).x, std::exp(-0.2), 1e-6);
  Scene open;
  open.materials = {absorbing(1, true)};
  open.meshes = {make_wall(-0.1, 0.1, 0.1)};
  EXPECT_EQ(Accelerator(open).transmittance(ray, 1).x, 1);
  EXPECT_EQ(Accelerator(open).transmittance({{0.0013, 0.0007, -1}, {0, 0, 1}}, 2).x, 1) << "a sheet seen from behind";
}

// Light that glass bends on its way to a wall in it: a caustic. The wall is 0.2 m below the face.
TEST(AbsorbingSolids, DimCaustics) {
  const std::vector<Light> lights{
      PointLight{{0.001, 0, -0.01}, {1, 1, 1}}, DirectionalLight{{0, 0, -1}, {1, 1, 1}},
      RectangleLight{{0.001, 0, -0.01}, {0, 1e-3, 0}, {1e-3, 0, 0}, {1e6, 1e6, 1e6}, false}};
  for (const Light& light : lights) {
    Scene with = wall_and_block(-0.5, -0.1, 1.5, true), without = wall_and_block(-0.5, -0.1, 1.5, false);
    with.lights = without.lights = {light};
    expect_share(light_seen(with, "ESDSL"), light_seen(without, "ESDSL"), share_after(0.4), 1e-3);
  }
}

/// Adds a medium of particles, evenly in a box or with the density of a grid, which is half as thick in its lower half.
void add_fog(Scene& scene, double low, double high, Vec3 extinction, double albedo, bool is_grid) {
  Medium& fog = scene.media.emplace_back();
  fog.name = "fog";
  fog.extinction = extinction;
  fog.material = int(scene.materials.size());
  scene.materials.emplace_back(ScatteringMaterial{.albedo = Vec3{1, 1, 1} * albedo});
  fog.is_open = true;
  fog.box = MediumBox{{-1, -1, low}, {1, 1, high}};
  if (!is_grid) return;
  Image density(2, 1, 1);
  density(0, 0) = 0.5F;
  density(1, 0) = 1;
  fog.density = {std::make_shared<Image>(density), 2};
}

// Fog between a lamp and the glass over a wall. It is crossed on the way to the lamp and by the camera: here the light after the
// first surface that scatters counts, as the hit of a camera is weighted apart. In a grid ratio tracking estimates the share: its
// relative variance on a way of thickness τ is below 1 at τ = 0.3 with local majorants, so 4/√n is 0.06 with n = 4096 draws, but draws
// of one place are the same: rectangles have many.
TEST(MediaAndCaustics, FogDimsCaustics) {
  const double thickness = 0.2 * 3;
  for (const bool is_grid : {false, true}) {
    const auto light_on_wall = [&](const Light& light, bool has_fog, int samples) {
      Scene scene = wall_and_block(-0.5, -0.29, 1.5, false);
      scene.lights = {light};
      if (has_fog) add_fog(scene, -0.25, -0.05, {3, 3, 3}, 0.5, is_grid);
      return light_seen(scene, "ESDSL", {.rays = samples, .z = -0.26, .max_depth = 3}).y;
    };
    const PointLight point{{0.001, 0, -0.01}, {1, 1, 1}};
    if (!is_grid) {
      EXPECT_NEAR(light_on_wall(point, true, 1) / light_on_wall(point, false, 1) / std::exp(-thickness), 1, 1e-4);
      const DirectionalLight sun{{0, 0, -1}, {1, 1, 1}};
      EXPECT_NEAR(light_on_wall(sun, true, 1) / light_on_wall(sun, false, 1) / std::exp(-thickness), 1, 1e-4);
    }
    const RectangleLight square{{0.001, 0, -0.01}, {0, 1e-3, 0}, {1e-3, 0, 0}, {1e6, 1e6, 1e6}, false};
    const double mean = is_grid ? 0.75 : 1;  // of the density
    EXPECT_NEAR(light_on_wall(square, true, 64) / light_on_wall(square, false, 64) / std::exp(-thickness * mean), 1,
                is_grid ? 0.06 : 2e-3);
  }
}

// Milky glass lit from above: a particle at the depth z below the face gets E = I·T/(h + z/n)² of a lamp at the height h, and sends
// back ω/(4π)·E. Seen head-on, that is T/n² of ∫σ·ω/(4π)·E·exp(−2σz) dz. Each of 16,384 paths meets a particle with the
// probability 0.86; light varies by less than its mean: 4/√n = 0.03.
TEST(MediaAndCaustics, PointLightsShineIntoMediaBehindGlass) {
  constexpr double sigma = 20, depth = 0.1, h = 0.09, n = 1.5, passed = 0.96, albedo = 0.5;
  Scene scene;
  scene.materials = {DielectricMaterial{.index = constant_index(n)}};
  add_block(scene, -0.1 - depth, -0.1);
  Medium& milk = scene.media.emplace_back();
  milk.name = "milk";
  milk.extinction = {sigma, sigma, sigma};
  milk.material = 1;
  scene.materials.emplace_back(ScatteringMaterial{.albedo = Vec3{1, 1, 1} * albedo});
  scene.materials[0].medium = 0;
  scene.lights = {PointLight{{0.001, 0, -0.1 + h}, {1, 1, 1}}};
  double expected = 0;
  constexpr int steps = 1000;
  for (int i = 0; i < steps; ++i) {
    const double z = (i + 0.5) * depth / steps;
    expected += sigma * albedo / (4 * pi) * passed / std::pow(h + z / n, 2) * std::exp(-2 * sigma * z) * depth / steps;
  }
  EXPECT_NEAR(light_seen(scene, "ESGSL", {.rays = 16384, .paths = 1, .max_depth = 3}).y / (expected * passed / (n * n)),
              1, 0.03);
}

/// Fraction of unpolarised light that a face between two indices lets pass (Born and Wolf, 1.5.2).
double passed_face(double n1, double n2, double angle) {
  const double cos1 = std::cos(angle), cos2 = std::sqrt(1 - std::pow(n1 / n2 * std::sin(angle), 2));
  const double s = (n1 * cos1 - n2 * cos2) / (n1 * cos1 + n2 * cos2),
               p = (n2 * cos1 - n1 * cos2) / (n2 * cos1 + n1 * cos2);
  return 1 - (s * s + p * p) / 2;
}

/// Mean over a window x0 … x1, |y| < half, |z| < deep of σ/(4π) times the fluence along z, of light from (−d, 0) through a ball around 0. Rays are
/// traced in their plane; each brings its power along its length.
double light_of_shaft(double d, double radius, double n, double x0, double x1, double half, double deep, double sigma) {
  double sum = 0;
  constexpr int angles = 2000, turns = 90, steps = 40;
  const double edge = std::asin(radius / d);
  for (int i = 0; i < angles; ++i) {
    const double theta = edge * (i + 0.5) / angles;
    const double enters = std::asin(d * std::sin(theta) / radius), inside = std::asin(std::sin(enters) / n);
    const double power =
        passed_face(1, n, enters) * passed_face(n, 1, inside) * 2 * pi * std::sin(theta) * edge / angles;
    const double turned = theta - 2 * (enters - inside);
    const double exit = 2 * inside - (enters - theta);  // of the place where it leaves, from +x toward the same side
    const double x = radius * std::cos(exit), rho = radius * std::sin(exit);
    for (int j = 0; j < steps; ++j) {
      const double at = x0 + (x1 - x0) * (j + 0.5) / steps;
      if (at < x) continue;
      const double off = std::abs(rho + (at - x) * std::tan(turned));
      for (int k = 0; k < turns; ++k)
        if (const double turn = 2 * pi * (k + 0.5) / turns;
            std::abs(off * std::cos(turn)) < half && std::abs(off * std::sin(turn)) < deep)
          sum += power / turns * (x1 - x0) / steps / std::cos(turned);
    }
  }
  return sum * sigma / (4 * pi) / ((x1 - x0) * 2 * half);
}

// A shaft of light of a point lamp behind a glass ball in fog so thin that it dims nothing, seen from the side, against rays traced
// through the exact ball.
TEST(MediaAndCaustics, AGlassBallThrowsAShaftOfLight) {
  constexpr double sigma = 1e-3, far = 60_mm, radius = 5_mm;
  Scene scene;
  scene.materials = {DielectricMaterial{.index = constant_index(1.5)}};
  scene.meshes = {make_sphere(2 * radius, 100)};
  for (Vec3& p : scene.meshes[0].positions) p.z -= 0.1;
  scene.lights = {PointLight{{-far, 0, -0.1}, {1, 1, 1}}};
  add_fog(scene, -0.15, -0.05, Vec3{1, 1, 1} * sigma, 1, false);
  const PathScene path_scene(scene, Lines{}, {"EGSSL"}, {.max_depth = 4});
  // The focus lies 9 mm behind the middle of the ball; light along the axis before it has no finite variance.
  for (const auto& [x0, x1] : {std::pair{14_mm, 20_mm}, {40_mm, 60_mm}}) {
    constexpr double half = 6_mm;
    Statistics statistics;
    PathCounts counts;
    CounterRandom random(1, 0, 0);
    for (int i = 0; i < 2500; ++i) {
      const double u = random.uniform(), v = random.uniform();
      const Ray ray{{x0 + (x1 - x0) * u, half * (2 * v - 1), -0.01}, {0, 0, -1}};
      const auto particle = path_scene.accelerator.particle_before(ray, 1);
      ASSERT_TRUE(particle.has_value());
      Vec3 sum;
      mean_radiance(path_scene, {particle->point, -ray.direction, path_scene.automaton.start(), 1}, 1, uint64_t(i),
                    {&sum, 1}, counts);
      statistics.add(sum.y * particle->weight.y);
    }
    const double expected = light_of_shaft(far, radius, 1.5, x0, x1, half, 0.05, sigma);
    EXPECT_LT(statistics.standard_error(), 0.06 * expected);
    EXPECT_NEAR(statistics.mean(), expected, 4 * statistics.standard_error());
  }
}

}  // namespace
}  // namespace holotrace
