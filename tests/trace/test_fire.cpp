#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "holotrace/data/light_spectrum.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/render.h"
#include "holotrace/trace/trace.h"
#include "trace/scenes.h"

// Light by temperature: media of black particles, and meshes with a spectrum, against Planck's law.

namespace holotrace {
namespace {

const Grid fire_panel{64, 64, 8e-6};
constexpr double fire_field = 0.01;  // half the field [rad]: cosines are 1 up to 5e-5

/// Radiance of a nanometre of the spectrum of a black body [W/m²/sr]: 2hc²/λ⁵/(exp(hc/(λkT)) − 1), constants of CODATA 2018.
double black_body(double wavelength, double kelvin) {
  constexpr double h = 6.62607015e-34, c = 299792458, k = 1.380649e-23;
  return 1e-9 * 2 * h * c * c / std::pow(wavelength, 5) / (std::exp(h * c / (wavelength * k * kelvin)) - 1);
}

Vec3 at_lines(double kelvin) {
  return {black_body(red_line, kelvin), black_body(green_line, kelvin), black_body(blue_line, kelvin)};
}

struct Flame {
  double extinction = 5, albedo = 0, factor = 1;
  std::vector<float> kelvin{1800};  // of equal layers, from back to front
};

/// A flame from z = −0.4 to −0.2 m.
Scene make_flame(const Flame& flame) {
  Scene scene;
  Medium medium;
  medium.name = "flame";
  medium.material = 0;
  medium.extinction = Vec3{1, 1, 1} * flame.extinction;
  medium.is_open = true;
  medium.box = MediumBox{{-1, -1, -0.4}, {1, 1, -0.2}};
  Image cells(int(flame.kelvin.size()), 1, 1);
  std::copy(flame.kelvin.begin(), flame.kelvin.end(), cells.values.begin());
  medium.temperature = {std::make_shared<Image>(std::move(cells)), int(flame.kelvin.size())};
  scene.materials.emplace_back(ScatteringMaterial{.albedo = Vec3{1, 1, 1} * flame.albedo, .blackbody = flame.factor});
  scene.media.push_back(std::move(medium));
  return scene;
}

Vec3 mean_light(const Scene& scene, int paths, const std::vector<std::string>& expressions = {"E.*L"}) {
  RenderParams params{.columns = 8, .rows = 8, .paths = paths};
  params.field_of_view = fire_field;
  params.path_expressions = expressions;
  const Image image = render(scene, fire_panel, green_light, params);
  Vec3 sum;
  for (size_t i = 0; i < image.values.size(); i += 3)
    sum += Vec3{image.values[i], image.values[i + 1], image.values[i + 2]};
  return sum / 64;
}

void expect_ratio(Vec3 found, Vec3 expected, double tolerance) {
  EXPECT_NEAR(found.x / expected.x, 1, tolerance);
  EXPECT_NEAR(found.y / expected.y, 1, tolerance);
  EXPECT_NEAR(found.z / expected.z, 1, tolerance);
}

// Of the thickness τ, a flame has the share 1 − exp(−τ) of a black body's light, times its absorbed part if it scatters. A path brings
// light with the probability of a particle, p: 4·√((1 − p)/(p·n)) is 0.02 at p = 0.63 and n = 64·1024, at τ = 20 there is no noise.
TEST(Fire, HasTheLightOfABlackBodyByItsThickness) {
  expect_ratio(mean_light(make_flame({}), 1024), at_lines(1800) * (1 - std::exp(-1.0)), 0.02);
  expect_ratio(mean_light(make_flame({.extinction = 100}), 16), at_lines(1800), 1e-5);
  expect_ratio(mean_light(make_flame({.extinction = 100, .kelvin = {2400}}), 16), at_lines(2400), 1e-5);
  expect_ratio(mean_light(make_flame({.albedo = 0.4, .factor = 3}), 1024, {"EL"}),
               at_lines(1800) * (3 * 0.6 * (1 - std::exp(-1.0))), 0.02);
}

// What is not scattered is absorbed and shines, whatever the spectra of surfaces: an albedo is no colour of a surface.
TEST(Fire, OfAColouredAlbedoIsThatOfItsAbsorbedPart) {
  Material material(ScatteringMaterial{.albedo = {0.9, 0.3, 0.05}, .blackbody = 2});
  SurfacePoint point;
  point.colour = {1, 1, 1};
  for (const bool is_smooth : {false, true}) {
    Lines lines;
    if (is_smooth) lines.reflectances = &reflectance_table(lines.wavelengths);
    EXPECT_LT(length(emitted_radiance(material, point, lines) - Vec3{0.2, 1.4, 1.9}), 1e-12) << is_smooth;
  }
}

// Temperatures are interpolated between the middles of layers: ∫σ·B(T(t))·exp(−σt) dt. The light of particles varies by about its
// mean: 4·√2/√n = 0.02.
TEST(Fire, OfSeveralTemperaturesHasTheirIntegral) {
  const std::vector<float> kelvin{1200, 2000, 0, 1500};
  Vec3 expected;
  constexpr int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    const double t = (i + 0.5) / steps * 0.2, place = (0.2 - t) / 0.05 - 0.5;
    const int low = std::clamp(int(std::floor(place)), 0, 2);
    const double share = std::clamp(place - low, 0.0, 1.0);
    const double here = kelvin[size_t(low)] * (1 - share) + kelvin[size_t(low) + 1] * share;
    if (here > 0) expected += at_lines(here) * (5 * std::exp(-5 * t) * 0.2 / steps);
  }
  expect_ratio(mean_light(make_flame({.kelvin = kelvin}), 1024), expected, 0.02);
}

// Waves begin at the particles, as bright as the flame; each ray of an even medium has one.
TEST(Fire, SendsWaves) {
  TraceParams params{.columns = 64, .rows = 64, .paths = 1};
  params.field_of_view = fire_field;
  const auto light_of = [&](const Scene& scene) {
    double sum = 0;
    for (const Source& wave : trace(scene, fire_panel, green_light, params).waves)
      sum += double(wave.amplitude) * double(wave.amplitude);
    return sum;
  };
  Scene wall;
  wall.materials = {grey(0, 1)};
  wall.meshes = {make_wall(-0.3, 50_mm, 50_mm)};
  EXPECT_NEAR(light_of(make_flame({})) / light_of(wall) / (black_body(green_light, 1800) * (1 - std::exp(-1.0))), 1,
              1e-3);  // squared cosines
}

// A wall that shines as a lamp of 3200 K: seen itself, and as the light of a diffuse wall, whose sampling of the lamp is noisy by
// 4·0.3/√n = 5e-3 with n = 64·1024 places.
TEST(EmissiveMeshes, HaveASpectrum) {
  const auto spectrum = std::make_shared<Spectrum>(blackbody_spectrum(3200));
  Scene scene;
  scene.materials = {grey(0, 2)};
  scene.meshes = {make_wall(-0.3, 50_mm, 50_mm)};
  scene.materials[0].emission_spectrum = spectrum;
  const Vec3 seen = mean_light(scene, 1), planck = at_lines(3200);
  EXPECT_NEAR(seen.y, 2 * spectrum->at(green_line), 1e-6);
  // The table has steps of 5 nm: its curvature makes 1e-4 of it.
  EXPECT_NEAR(seen.x / seen.y / (planck.x / planck.y), 1, 1e-3);
  EXPECT_NEAR(seen.z / seen.y / (planck.z / planck.y), 1, 1e-3);

  Scene lit;
  lit.materials = {grey(0.5), grey(0, 2)};
  lit.meshes = {make_wall(-0.3, 50_mm, 50_mm), make_test_quad({0, 60_mm, -0.25}, {20_mm, 0, 0}, {0, 0, 20_mm}, 1)};
  const Vec3 even = mean_light(lit, 1024);
  lit.materials[1].emission_spectrum = spectrum;
  const Vec3 by_spectrum = mean_light(lit, 1024);
  EXPECT_GT(even.y, 0);
  for (const auto& [light, line, without] : {std::tuple{by_spectrum.x, red_line, even.x},
                                             {by_spectrum.y, green_line, even.y},
                                             {by_spectrum.z, blue_line, even.z}})
    EXPECT_NEAR(light / without, spectrum->at(line), 5e-3 * spectrum->at(line));
}

}  // namespace
}  // namespace holotrace
