#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "holotrace/base/low_discrepancy.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/shade_triangles.h"
#include "holotrace/trace/trace.h"
#include "trace/scenes.h"

// Media against closed forms. Distances are in metres, coefficients in 1/m.

namespace holotrace {
namespace {

const Grid media_panel{64, 64, 8e-6};
constexpr double small_field = 0.01;  // half the field [rad]: cosines are 1 up to 5e-5

/// Adds a medium and its particles.
Medium& add_medium(Scene& scene, Vec3 extinction, const ScatteringMaterial& particles, Vec3 emission = {}) {
  Medium medium;
  medium.name = "fog";
  medium.extinction = extinction;
  medium.material = int(scene.materials.size());
  scene.materials.emplace_back(particles, emission);
  return scene.media.emplace_back(std::move(medium));
}

/// The same, in a box from z = low to z = high.
Medium& add_slab(Scene& scene, double low, double high, Vec3 extinction, const ScatteringMaterial& particles,
                 double half_width = 1) {
  Medium& medium = add_medium(scene, extinction, particles);
  medium.is_open = true;
  medium.box = MediumBox{{-half_width, -half_width, low}, {half_width, half_width, high}};
  return medium;
}

Vec3 mean_colour(const Image& image) {
  Vec3 sum;
  for (size_t i = 0; i < image.values.size(); i += 3)
    sum += Vec3{image.values[i], image.values[i + 1], image.values[i + 2]};
  return sum / (double(image.values.size()) / 3);
}

Vec3 seen(const Scene& scene, int paths, int max_depth = 500, const std::vector<std::string>& expressions = {"E.*L"}) {
  RenderParams params{.columns = 8, .rows = 8, .paths = paths};
  params.field_of_view = small_field;
  params.max_depth = max_depth;
  params.roulette_depth = max_depth;
  params.path_expressions = expressions;
  params.has_background = true;
  return mean_colour(render(scene, media_panel, green_light, params));
}

void expect_near(Vec3 value, Vec3 expected, double tolerance) {
  EXPECT_NEAR(value.x, expected.x, tolerance);
  EXPECT_NEAR(value.y, expected.y, tolerance);
  EXPECT_NEAR(value.z, expected.z, tolerance);
}

Vec3 exponential(Vec3 v) { return {std::exp(v.x), std::exp(v.y), std::exp(v.z)}; }

// A wall 0.3 m behind the panel in absorbing fog. Each of n = 8·8·4096 paths brings a weight of at most 3, of a variance below 2:
// 4 standard errors are 4·√(2/n) = 0.011.
TEST(Media, LightFromBehindIsDimmedExponentiallyInEachColour) {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_wall(-0.3, 50_mm, 50_mm)};
  const Vec3 extinction{1, 3, 8};
  add_medium(scene, extinction, {.albedo = {0, 0, 0}}).is_open = true;
  expect_near(seen(scene, 4096), exponential(extinction * -0.3), 0.011);
}

// The waves themselves are dimmed by √T, not drawn: exact up to the rounding of single precision.
TEST(Media, WavesFromBehindAreDimmed) {
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_wall(-0.3, 50_mm, 50_mm)};
  const TraceParams params{.columns = 10, .rows = 10, .paths = 1};
  const Sources clear = trace(scene, media_panel, green_light, params);
  add_slab(scene, -0.25, -0.05, {4, 4, 4}, {.albedo = {0, 0, 0}});
  for (const SourcePhase phase : {SourcePhase::random, SourcePhase::path}) {
    TraceParams dimmed = params;
    dimmed.phase = phase;
    const Sources fogged = trace(scene, media_panel, green_light, dimmed);
    ASSERT_EQ(fogged.waves.size(), clear.waves.size());
    for (size_t i = 0; i < clear.waves.size(); ++i) {
      const Vec3 o = clear.waves[i].origin;
      const double inside = 0.2 * length(o) / std::abs(o.z);
      EXPECT_NEAR(fogged.waves[i].amplitude / clear.waves[i].amplitude, std::exp(-2 * inside), 1e-6);
    }
  }
}

/// The mean over rays along −z through points of a square of 0.1 m.
template <class Of>
Vec3 mean_over_rays(const Of& of, int count) {
  Vec3 sum;
  for (int i = 0; i < count; ++i) {
    const Vec2 u{(i + 0.5) / count, std::fmod(i * 0.6180339887498949, 1)};
    sum += of(Ray{{0.1 * u.x - 0.05, 0.1 * u.y - 0.05, 0}, {0, 0, -1}});
  }
  return sum / count;
}

/// A grid of this density at the centres of 20 cells along z, alike across.
template <class Density>
void set_density(Medium& medium, const Density& density) {
  constexpr int cells = 20;
  Image grid(cells * 3, 5, 1);
  for (int k = 0; k < cells; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 5; ++i) grid(3 * k + j, i) = float(density((k + 0.5) / cells));
  medium.density = {std::make_shared<Image>(std::move(grid)), cells};
}

// The part of the rays that fly through, and the share of shadow rays, of a slab whose density falls linearly along z. Between the
// centres of the first and last cell interpolation is exact; the half cells at the ends add (1.95 + 0.05)/2 of 1/20: the integral is
// that of the line, 1. Real flights: 4·√(T(1 − T)/n) = 0.008 for n = 6e4. Ratio tracking varies less.
TEST(Media, GridsDimAsTheirIntegral) {
  Scene scene;
  Medium& medium = add_slab(scene, -0.4, -0.2, {5, 10, 2}, {});
  set_density(medium, [](double z) { return 2 * z; });
  const Accelerator accelerator(scene);
  constexpr int count = 60'000;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Vec3 expected = exponential(medium.extinction * -0.2);
  expect_near(mean_over_rays([&](const Ray& ray) { return accelerator.transmittance(ray, infinity); }, count), expected,
              0.008);
  const auto passing = [&](const Ray& ray) {
    Hit hit;
    return accelerator.closest_hit(ray, hit) ? Vec3{} : hit.weight;
  };
  expect_near(mean_over_rays(passing, count), expected, 0.012);  // weights up to 3: a variance below 0.5
  // Up to the middle, which is less dense away from the panel: a quarter of the whole is behind it.
  const auto to_middle = [&](const Ray& ray) { return accelerator.transmittance(ray, 0.3); };
  expect_near(mean_over_rays(to_middle, count), exponential(medium.extinction * (-0.2 * 0.75)), 0.008);
}

// A thin layer beside the edge of two blocks of majorants: 1 in the middle of cell 8, and linear to 0 at the middles of cells 7 and 9;
// its integral is 1/20 of the slab. Tolerances as above.
TEST(Media, AThinLayerOfAGridIsNotMissed) {
  Scene scene;
  Medium& medium = add_slab(scene, -0.4, -0.2, {100, 100, 100}, {});
  set_density(medium, [](double z) { return int(z * 20) == 8; });
  const Accelerator accelerator(scene);
  const auto passing = [&](const Ray& ray) {
    Hit hit;
    return accelerator.closest_hit(ray, hit) ? Vec3{} : hit.weight;
  };
  const auto share = [&](const Ray& ray) { return accelerator.transmittance(ray, 1); };
  expect_near(mean_over_rays(passing, 60'000), Vec3{1, 1, 1} * std::exp(-1.0), 0.008);
  expect_near(mean_over_rays(share, 60'000), Vec3{1, 1, 1} * std::exp(-1.0), 0.008);
}

// Particles of a grid of even density lie as those of an even medium: at depth t with the density σ·exp(−σt). The mean weight of
// those before t is 1 − exp(−σt), for weights in three colours.
TEST(Media, ParticlesOfAGridLieAsThoseOfAnEvenMedium) {
  for (const bool is_grid : {false, true}) {
    Scene scene;
    Medium& medium = add_slab(scene, -0.4, -0.2, {5, 10, 2}, {});
    if (is_grid) set_density(medium, [](double) { return 1; });
    const Accelerator accelerator(scene);
    for (const double depth : {0.05, 0.1, 0.2}) {
      const Vec3 expected = Vec3{1, 1, 1} - exponential(medium.extinction * -depth);
      const auto flown = [&](const Ray& ray) {
        Hit hit;
        return accelerator.closest_hit(ray, hit) && hit.distance < 0.2 + depth ? hit.weight : Vec3{};
      };
      const auto surely = [&](const Ray& ray) {
        const auto hit = accelerator.particle_before(ray, 1);
        return hit && hit->distance < 0.2 + depth ? hit->weight : Vec3{};
      };
      expect_near(mean_over_rays(flown, 60'000), expected, 0.012);  // as above
      expect_near(mean_over_rays(surely, 60'000), expected, 0.012);
    }
  }
}

// The innermost medium counts, glass is empty, and a ray that begins inside knows where it is.
TEST(Media, RaysKnowInWhichMediumTheyAre) {
  Scene scene;
  scene.materials = {DielectricMaterial{}, grey(0)};
  scene.materials[1].opacity = 0;
  scene.materials[1].medium = 1;
  add_slab(scene, -1, -0.01, {1, 1, 1}, {});
  add_medium(scene, {10, 10, 10}, {});
  scene.meshes = {make_round_mesh({0, 0, -0.3}, 0.1, 64), make_round_mesh({0, 0, -0.7}, 0.1, 64),
                  make_round_mesh({0, 0, -0.7}, 0.02, 64)};
  scene.meshes[1].material = 1;
  const Accelerator accelerator(scene);
  const auto thickness = [&](Vec3 from, Vec3 to) {
    return -std::log(accelerator.transmittance({from, normalize(to - from)}, length(to - from)).x);
  };
  constexpr double facets = 3e-4;  // π²/(2·128²) of the radius, at σ = 10/m, both sides
  const Vec3 x{1e-4, 2e-4, 0};     // off the poles
  EXPECT_NEAR(thickness(x + Vec3{0, 0, -0.3}, x + Vec3{0, 0, -0.5}), 0.1, facets);  // out of glass into fog
  EXPECT_NEAR(thickness(x + Vec3{0, 0, -0.65}, x + Vec3{0, 0, -0.5}), 10 * 0.05 + 0.1, 10 * facets);
  EXPECT_NEAR(thickness(x + Vec3{0, 0, -0.7}, x + Vec3{0, 0, -0.69}), 0, 1e-12);  // in glass in the medium
  EXPECT_NEAR(thickness(x + Vec3{0, 0, -0.7}, x + Vec3{0.2, 0, -0.7}), 10 * 0.08 + 0.1, 20 * facets);
  EXPECT_NEAR(thickness(x, x + Vec3{0, 0, -2}), 0.19 + 0.2 + 10 * 0.16 + 0.2, 40 * facets);
}

// Light along −z is scattered back once by a slab of the thickness D: L = ω·p(180°)·E·(1 − exp(−2σD))/2. Every path has a particle
// with the probability 1 − exp(−σD) = 0.78 and light of it: n = 64·1024 have a relative standard error of 0.3 %.
TEST(Media, ASlabScattersOnceAsItsIntegral) {
  for (const double g : {0.0, -0.5, 0.8}) {
    Scene scene;
    add_slab(scene, -0.4, -0.2, {5, 7.5, 10}, {.albedo = {0.5, 0.4, 0.3}, .anisotropy = g});
    scene.lights = {DirectionalLight{{0, 0, -1}, {3, 3, 3}}};
    const double back = (1 - g * g) / (4 * pi * std::pow(1 + g, 3));
    const auto expected = [&](double sigma, double albedo) {
      return albedo * back * 3 * (1 - std::exp(-2 * sigma * 0.2)) / 2;
    };
    const Vec3 found = seen(scene, 1024, 500, {"EGL"});
    EXPECT_NEAR(found.x / expected(5, 0.5), 1, 0.02) << g;
    EXPECT_NEAR(found.y / expected(7.5, 0.4), 1, 0.02) << g;
    EXPECT_NEAR(found.z / expected(10, 0.3), 1, 0.02) << g;
  }
}

// The same of a ball behind an interface without refraction, along its diameter D. The field is so small that chords are D up to 1e-4;
// facets shorten them by 3e-4.
TEST(Media, ABallScattersOnceAsItsIntegral) {
  Scene scene;
  scene.materials = {grey(0)};
  scene.materials[0].opacity = 0;
  scene.materials[0].medium = 0;
  add_medium(scene, {5, 5, 5}, {.albedo = {0.5, 0.5, 0.5}});
  scene.meshes = {make_round_mesh({0, 0, -0.3}, 0.1, 64)};
  scene.lights = {DirectionalLight{{0, 0, -1}, {3, 3, 3}}};
  RenderParams params{.columns = 8, .rows = 8, .paths = 1024};
  params.field_of_view = 0.002;
  params.path_expressions = {"EGL"};
  const double found = mean_colour(render(scene, media_panel, green_light, params)).x;
  EXPECT_NEAR(found / (0.5 / (4 * pi) * 3 * (1 - std::exp(-2 * 5 * 0.2)) / 2), 1, 0.02);  // as above
}

// Light of the same brightness from everywhere stays that bright in a medium that absorbs nothing: every single path brings 1, but
// for those of three colours, whose weights have the mean 1: 4·√(2/n) = 0.02 for n = 64·1024.
TEST(Media, AWhiteBallInAFurnaceCannotBeSeen) {
  const auto ball = [](const Material& boundary, Vec3 extinction, double g) {
    Scene scene;
    scene.materials = {boundary};
    scene.materials[0].medium = 0;
    add_medium(scene, extinction, {.anisotropy = g});
    scene.meshes = {make_round_mesh({0, 0, -0.3}, 0.1, 16)};
    scene.background = {1, 1, 1};
    return scene;
  };
  Material interface = grey(0);
  interface.opacity = 0;
  expect_near(seen(ball(interface, {20, 20, 20}, 0), 64), {1, 1, 1}, 1e-6);
  expect_near(seen(ball(interface, {20, 20, 20}, 0.7), 64), {1, 1, 1}, 1e-6);
  expect_near(seen(ball(interface, {2, 5, 8}, 0), 1024), {1, 1, 1}, 0.02);
  // Glass keeps n² times the radiance inside, and total reflection sends long paths around: less than 1e-4 of them is cut after 500.
  expect_near(seen(ball(DielectricMaterial{}, {20, 20, 20}, 0.3), 256), {1, 1, 1}, 2e-3);
  // An environment map is sampled by shadow rays, too.
  Scene lit = ball(interface, {10, 10, 10}, 0.5);
  lit.background = {};
  Image map(2, 4, 3);
  std::fill(map.values.begin(), map.values.end(), 1.0F);
  lit.environment = Environment{std::make_shared<Image>(std::move(map))};
  expect_near(seen(lit, 1024), {1, 1, 1},
              0.01);  // 4 standard errors of 64·1024 paths whose light varies by less than 0.6
}

// Chandrasekhar's H(μ) for isotropic scattering, by iteration of 1/H = √(1 − ω) + ω/2·∫ H(μ')·μ'/(μ + μ') dμ'.
double albedo_of_half_space(double omega, double mu) {
  constexpr int n = 400;
  std::vector<double> h(n, 1.0);
  const auto at = [&](double from) {
    double sum = 0;
    for (int j = 0; j < n; ++j) {
      const double m = (j + 0.5) / n;
      sum += h[size_t(j)] * m / (from + m) / n;
    }
    return 1 / (std::sqrt(1 - omega) + omega / 2 * sum);
  };
  for (int step = 0; step < 200; ++step) {
    std::vector<double> next(n);
    for (int i = 0; i < n; ++i) next[size_t(i)] = at((i + 0.5) / n);
    h = next;
  }
  return 1 - std::sqrt(1 - omega) * at(mu);
}

// What a half space of isotropic particles reflects of light from all sides, seen head-on (S. Chandrasekhar, Radiative Transfer, 1950,
// section 35; by reciprocity the albedo for light that falls head-on). 4 standard errors of 64·512 paths, below 4·0.5/√n.
TEST(Media, AHalfSpaceReflectsAsChandrasekharsFunction) {
  EXPECT_NEAR(albedo_of_half_space(0.9, 1), 1 - std::sqrt(0.1) * 1.8501, 1e-4);  // H(1) of his table XI
  for (const double omega : {0.5, 0.9, 0.99}) {
    Scene scene;
    add_slab(scene, -1.2, -0.2, {100, 100, 100}, {.albedo = Vec3{1, 1, 1} * omega}, 20);
    scene.background = {1, 1, 1};
    EXPECT_NEAR(seen(scene, 512).x, albedo_of_half_space(omega, 1), 0.011) << omega;
  }
  // The albedo does not depend on the extinction, which differs from colour to colour here; weights then vary more.
  Scene scene;
  add_slab(scene, -1.2, -0.2, {80, 100, 120}, {.albedo = {0.5, 0.7, 0.8}}, 20);
  scene.background = {1, 1, 1};
  expect_near(seen(scene, 2048),
              {albedo_of_half_space(0.5, 1), albedo_of_half_space(0.7, 1), albedo_of_half_space(0.8, 1)}, 0.011);
}

// A wall under absorbing fog, lit by an even sky: L = ρ·exp(−τ)·2·E₃(τ), E₃ = ∫₀¹ μ·exp(−τ/μ) dμ, in each colour.
// 4 standard errors of 64·4096 paths, below 4·1/√n.
TEST(Media, TheSkyIsDimmedOnItsWayToAWallAndBack) {
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_wall(-0.3, 20, 20)};
  const Vec3 extinction{1, 3, 6};
  add_slab(scene, -0.3, -0.1, extinction, {.albedo = {0, 0, 0}}, 20);
  scene.background = {1, 1, 1};
  const auto expected = [](double tau) {
    constexpr int n = 2000;
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += (i + 0.5) / n * std::exp(-tau * n / (i + 0.5)) / n;
    return 0.5 * std::exp(-tau) * 2 * sum;
  };
  const Vec3 found = seen(scene, 4096), light{expected(0.2), expected(0.6), expected(1.2)};
  expect_near(found, light, 0.008);
}

// Emitting particles: j = σ_a·L_e in a slab, seen through the slab: L = (1 − ω)·L_e·(1 − exp(−σD)) for an albedo ω ≈ 0 in effect.
TEST(Media, AFlameShinesAsItsIntegral) {
  Scene scene;
  Medium& flame = add_medium(scene, {5, 5, 5}, {.albedo = {0, 0, 0}}, {2, 3, 4});
  flame.is_open = true;
  flame.box = MediumBox{{-1, -1, -0.4}, {1, 1, -0.2}};
  expect_near(seen(scene, 1024), Vec3{2, 3, 4} * (1 - std::exp(-1.0)), 0.04);  // 4·4·√(T(1 − T)/n)
}

// Particles and surroundings of one temperature: the light is the same everywhere, whatever is scattered. Every path brings 1.
TEST(Media, AnEvenlyHotMediumCannotBeSeenInItsFurnace) {
  Scene scene;
  const double albedo = 0.6;
  Medium& hot = add_medium(scene, {10, 10, 10}, {.albedo = Vec3{1, 1, 1} * albedo, .anisotropy = 0.3},
                           Vec3{1, 1, 1} * (1 - albedo));
  hot.is_open = true;
  hot.box = MediumBox{{-0.1, -0.1, -0.4}, {0.1, 0.1, -0.2}};
  scene.background = {1, 1, 1};
  expect_near(seen(scene, 1024), {1, 1, 1}, 0.01);  // 4 standard errors of 64·1024 paths that vary by less than 0.6
}

// A background behind absorbing fog, by paths together and, with a clamp that nothing reaches, one by one.
TEST(Media, TheBackgroundIsDimmedInEachColour) {
  Scene scene;
  const Vec3 extinction{1, 5, 10};
  add_slab(scene, -0.4, -0.2, extinction, {.albedo = {0, 0, 0}});
  scene.background = {1, 1, 1};
  for (const double clamp : {0.0, 100.0}) {
    RenderParams params{.columns = 8, .rows = 8, .paths = 4096};
    params.field_of_view = small_field;
    params.clamp = clamp;
    expect_near(mean_colour(render(scene, media_panel, green_light, params)), exponential(extinction * -0.2), 0.011);
  }
}

// A wall in absorbing fog, lit from the panel's side: dimmed on the way there and back. Lamps are small and far away, so that all ways
// are 0.3 m and 0.3 m long up to 1 %, at σ = 2/m. The noise is that of paths which fly through: 4·√((1 − T)/(T·n)) = 0.01 for T = 0.55
// and n = 64·2048.
TEST(Media, LampsOfEveryKindAreDimmed) {
  const auto scene_by = [](const Light& light, bool has_fog, bool is_glossy) {
    Scene scene;
    scene.materials = {grey(0.5)};
    if (is_glossy) scene.materials[0] = MetallicRoughnessMaterial{.metallic = 0.5, .roughness = 1};
    scene.meshes = {make_wall(-0.3, 10_mm, 10_mm)};
    scene.lights = {light};
    if (has_fog) add_slab(scene, -0.35, 0, {2, 2, 2}, {.albedo = {0, 0, 0}});
    return scene;
  };
  const auto seen_by = [&](const Light& light, bool has_fog, bool is_glossy) {
    return seen(scene_by(light, has_fog, is_glossy), 2048).y;
  };
  // Waves are dimmed by factors, without noise.
  const auto waves_by = [&](const Light& light, bool has_fog, bool is_glossy) {
    TraceParams params{.columns = 10, .rows = 10, .paths = 4};
    params.field_of_view = small_field;
    double sum = 0;
    for (const Source& wave : trace(scene_by(light, has_fog, is_glossy), media_panel, green_light, params).waves)
      sum += double(wave.amplitude) * double(wave.amplitude);
    return sum;
  };
  const PointLight point{{10_mm, 0, 0}, {1, 1, 1}};
  const RectangleLight rectangle{{10_mm, 0, 0}, {0, 4_mm, 0}, {4_mm, 0, 0}, {100, 100, 100}, false};
  for (const bool is_glossy : {false, true})
    for (const Light& light : {Light(point), Light(rectangle)}) {
      EXPECT_NEAR(seen_by(light, true, is_glossy) / seen_by(light, false, is_glossy) / std::exp(-1.2), 1, 0.02);
      EXPECT_NEAR(waves_by(light, true, is_glossy) / waves_by(light, false, is_glossy) / std::exp(-1.2), 1, 0.01);
    }
}

// Waves begin at the particles. Their light is that of the slab; each ray has one.
TEST(Media, WavesBeginAtParticles) {
  Scene scene;
  add_slab(scene, -0.4, -0.2, {5, 5, 5}, {.albedo = {0.5, 0.5, 0.5}});
  scene.lights = {DirectionalLight{{0, 0, -1}, {3, 3, 3}}};
  TraceParams params{.columns = 100, .rows = 100, .paths = 1};
  params.path_expressions = {"EGL"};
  params.field_of_view = small_field;
  const Sources fog = trace(scene, media_panel, green_light, params);
  ASSERT_EQ(fog.waves.size(), 1e4);
  double light = 0, depth = 0;
  for (const Source& wave : fog.waves) {
    ASSERT_TRUE(wave.origin.z <= -0.2 && wave.origin.z >= -0.4);
    light += double(wave.amplitude) * double(wave.amplitude);
    depth += -0.2 - wave.origin.z;
  }
  Scene wall;
  wall.materials = {grey(0, 1)};
  wall.meshes = {make_wall(-0.3, 50_mm, 50_mm)};
  params.path_expressions = {};
  double of_wall = 0;
  for (const Source& wave : trace(wall, media_panel, green_light, params).waves)
    of_wall += double(wave.amplitude) * double(wave.amplitude);
  const double expected = 0.5 / (4 * pi) * 3 * (1 - std::exp(-2.0)) / 2;
  EXPECT_NEAR(light / of_wall / expected, 1, 0.02);  // exp(−σt) varies by 0.3 of its mean: 4·0.3/√n
  const double mean = 0.2 - 0.2 * std::exp(-1.0) / (1 - std::exp(-1.0)) * 1.0;  // of t with the density ∝ exp(−σt)
  EXPECT_NEAR(depth / 1e4, mean, 0.003);                                        // 4·0.057/√n, and cosines
}

TEST(Media, RefusalsSayWhatToDo) {
  const auto error = [](const auto& change) {
    Scene scene;
    scene.materials = {grey(0.5), grey(0)};
    scene.materials[1].opacity = 0;
    scene.materials[1].medium = 0;
    scene.meshes = {make_wall(-0.5, 50_mm, 50_mm)};
    add_medium(scene, {1, 1, 1}, {});
    change(scene);
    return error_of([&] { Accelerator accelerator(scene); });
  };
  EXPECT_EQ(
      error([](Scene& s) { s.meshes.push_back(make_wall(-0.3, 50_mm, 50_mm, 1)); }),
      "expected a closed mesh around the medium \"fog\", got the mesh \"quad\" with 4 open edges; close it, or fill a "
      "box");
  EXPECT_EQ(
      error([](Scene& s) {
        s.meshes.push_back(make_round_mesh({}, 0.1, 8));
        s.meshes.back().material = 1;
      }),
      "expected the mesh \"sphere\" with the medium \"fog\" on one side of the panel, got one from z = -100 mm to "
      "100 mm; move it behind the panel");
  EXPECT_EQ(error([](Scene& s) {
              s.media[0].is_open = true;
              s.media[0].box = MediumBox{{-1, -1, -1}, {1, 1, 1}};
            }),
            "expected the box of the medium \"fog\" on one side of the panel, got one from z = -1 m to 1 m; let it end "
            "at z = 0");
  EXPECT_EQ(
      error([](Scene& s) { s.media[0].extinction.y = -1; }),
      "expected an extinction from 0 to 1e+09 /m of the medium \"fog\" (a mean free path of at least 1 nm), got (1, "
      "-1, 1)");
  EXPECT_EQ(error([](Scene& s) { std::get<ScatteringMaterial>(s.materials[2].surface).anisotropy = 1; }),
            "expected an anisotropy from -0.999 to 0.999 in material 2, got 1");
  EXPECT_EQ(error([](Scene& s) {
              s.media[0].box = MediumBox{{-1, -1, -2}, {1, 1, -1}};
              set_density(s.media[0], [](double z) { return z > 0.5 ? NAN : 1; });
            }),
            "expected finite densities of 0 or more of the medium \"fog\", got nan");
  EXPECT_EQ(
      error([](Scene& s) {
        s.media[0].box = MediumBox{{-1, -1, -2}, {1, 1, -1}};  // cells of 2/5 m, 2/3 m and 1/20 m
        set_density(s.media[0], [](double) { return 30'000; });
      }),
      "expected a density at which a cell of the medium \"fog\" is at most 10000 mean free paths thick, got 30000 "
      "and 20000; lower it, or take more cells");
  EXPECT_EQ(error([](Scene& s) {
              s.points = {{{0, 0, -0.1}}};
            }),
            "expected no luminous points in a scene with media, got 1; use small spheres that emit");
  Scene fog;
  fog.meshes = {make_wall(-0.5, 50_mm, 50_mm)};
  fog.materials = {grey(0.5)};
  add_medium(fog, {1, 1, 1}, {}).is_open = true;
  EXPECT_EQ(
      error_of([&] { trace(fog, media_panel, green_light, {.strategy = Strategy::tiled}); }),
      "expected the strategy shared or gather in a scene with media, got tiled, which does not know what media hide");
  EXPECT_EQ(error_of([&] { check_shading(fog, {}); }),
            "expected a scene without media for the method triangles, got the medium \"fog\"; use another method");
}

}  // namespace
}  // namespace holotrace
