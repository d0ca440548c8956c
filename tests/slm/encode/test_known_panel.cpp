#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <memory>

#include "holotrace/base/random.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/encode/low_pass.h"
#include "holotrace/slm/panel/show.h"
#include "support/panels.h"

// What an encoder knows of its panel without being told: the panel's own level table, wavefront errors and light.

namespace holotrace {
namespace {

using Complex = std::complex<double>;

constexpr int side = 96;

// Waves of a few low frequencies and of uneven moduli, within the stops of all encoders.
Field smooth_field(const Grid& grid) {
  Field field(grid, test_wavelength);
  CounterRandom random(7, 0, 0);
  for (int wave = 0; wave < 6; ++wave) {
    const double fx = random.uniform() * 6 - 3, fy = random.uniform() * 6 - 3, phase = random.uniform();
    for (int j = 0; j < grid.ny; ++j)
      for (int i = 0; i < grid.nx; ++i)
        field.samples(j, i) +=
            std::complex<float>(std::polar(1.0, 2 * pi * (phase + fx * i / grid.nx + fy * j / grid.ny)));
  }
  return field;
}

Array2D<float> map_of(const Grid& grid, const std::function<double(double, double)>& value) {
  Array2D<float> map(grid.ny, grid.nx);
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) map(j, i) = float(value(2.0 * i / grid.nx - 1, 2.0 * j / grid.ny - 1));
  return map;
}

// A panel with levels so fine that they do not count, 3 rad of error across and a wavefront error.
Slm bent_panel(Modulation modulation) {
  Slm slm = make_panel(side, side, 65536);
  slm.modulation = modulation;
  slm.effects.phase_map = std::make_shared<const Array2D<float>>(
      map_of(slm.grid, [](double x, double y) { return 3 * x * x - 2 * x * y; }));
  slm.effects.aberration = {{2, 0, 0.7}};
  slm.own_effects = {"aberration", "phase-map"};
  return slm;
}

struct MethodCase {
  Encoding method;
  Modulation modulation;
  double least;  // likeness
};

// The light of a hologram in its own stop.
Field light_of(const Hologram& hologram, const Slm& slm) {
  Field shown = show(hologram, slm, {});
  if (!shown.filter) return shown;
  for (int j = 0; j < shown.grid.ny; ++j)  // the middle of the stop onto the axis
    for (int i = 0; i < shown.grid.nx; ++i)
      shown.samples(j, i) *= std::complex<float>(
          std::polar(1.0, -2 * pi * (shown.filter->u0 * shown.grid.x(i) + shown.filter->v0 * shown.grid.y(double(j)))));
  return within_stop(shown, *shown.filter, {});
}

// |⟨a, b⟩|²/(⟨a, a⟩⟨b, b⟩): 1 for the same light.
double likeness(const Field& a, const Field& b) {
  Complex sum;
  double of_a = 0, of_b = 0;
  for (size_t i = 0; i < a.samples.size(); ++i) {
    const Complex u(a.samples.values[i]), v(b.samples.values[i]);
    sum += u * std::conj(v);
    of_a += std::norm(u);
    of_b += std::norm(v);
  }
  return std::norm(sum) / (of_a * of_b);
}

TEST(KnownPanel, EachPixelTakesTheNearestLevelOfThePanelsOwnTable) {
  // A piston array's levels, as measured [rad].
  const std::vector<double> phases{0,        0.062832, 0.128805, 0.265150, 0.351858, 0.456788, 0.710628, 1.089504,
                                   2.152619, 2.329177, 2.656531, 3.088814, 3.766141, 4.191513, 5.007699, 5.890486};
  Slm slm = make_panel(side, side, 16);
  for (const double phase : phases) slm.effects.calibration.push_back({phase, 1});
  Field field(slm.grid, test_wavelength);
  CounterRandom random(3, 0, 0);
  for (auto& sample : field.samples.values) sample = std::complex<float>(std::polar(1.0, 2 * pi * random.uniform()));
  const auto light_kept = [&](const Hologram& h) {
    Complex sum;
    for (size_t i = 0; i < field.samples.size(); ++i)
      sum += std::polar(1.0, phases[h.level.values[i]]) * std::conj(Complex(field.samples.values[i]));
    return std::norm(sum / double(field.samples.size()));
  };
  const Hologram unknown = encode(field, slm, {.method = Encoding::phase});
  // Iterations compensate all of the panel's own effects but flicker.
  slm.own_effects = {"calibration", "crosstalk", "flicker"};
  slm.effects.crosstalk = 0.1, slm.effects.flicker = 0.01;
  EXPECT_EQ(effects_of(known_panel(slm, {.method = Encoding::phase})), (std::vector<std::string>{"calibration"}));
  EXPECT_EQ(effects_of(known_panel(slm, {.method = Encoding::sgd})),
            (std::vector<std::string>{"calibration", "crosstalk"}));
  slm.effects.crosstalk = slm.effects.flicker = 0;
  slm.own_effects = {"calibration"};
  const Hologram known = encode(field, slm, {.method = Encoding::phase});
  EXPECT_EQ(known.effects, slm.own_effects);
  for (size_t i = 0; i < field.samples.size(); ++i) {
    const auto off = [&](size_t level) {
      return std::abs(std::arg(Complex(field.samples.values[i]) * std::polar(1.0, -phases[level])));
    };
    double least = pi;
    for (size_t level = 0; level < 16; ++level) least = std::min(least, off(level));
    EXPECT_NEAR(off(known.level.values[i]), least, 1e-6);  // phases of float samples
  }
  // For phases spread evenly, gaps of Δ to the next level keep the amplitude Σ 2·sin(Δ/2)/2π.
  double amplitude = 0;
  for (size_t level = 0; level < 16; ++level) {
    const double gap = level < 15 ? phases[level + 1] - phases[level] : 2 * pi - phases[15];
    amplitude += 2 * std::sin(gap / 2) / (2 * pi);
  }
  // 2304 phases: one standard error of the mean of cos(error), which varies by 0.03, is 6e-4, and the square's is 2 of it.
  EXPECT_NEAR(light_kept(known), amplitude * amplitude, 4e-3);
  EXPECT_LT(light_kept(unknown), 0.8);
  EXPECT_EQ(encode(field, slm, {.effects = {"none"}}).level.values, unknown.level.values);
}

// The light is nearly as like the wanted field as that of a flat panel. Fringes of the bent panel lie elsewhere, so light
// of the neighbouring orders in the stop differs, by some percent of that for this many pixels.
TEST(KnownPanel, WavefrontErrorsAreCompensatedByEveryEncoderOfPhases) {
  for (const auto& [method, modulation, least] : {MethodCase{Encoding::phase, Modulation::phase, 0.9999},
                                                  MethodCase{Encoding::complex, Modulation::complex, 0.9999},
                                                  MethodCase{Encoding::double_phase, Modulation::phase, 0.999},
                                                  MethodCase{Encoding::error_diffusion, Modulation::phase, 0.97},
                                                  MethodCase{Encoding::off_axis, Modulation::amplitude, 0.95},
                                                  MethodCase{Encoding::binary, Modulation::phase, 0.9},
                                                  MethodCase{Encoding::gerchberg_saxton, Modulation::phase, 0.9999}})
    for (const ImageSide image : {ImageSide::virtual_image, ImageSide::real_image}) {
      const Slm bent = bent_panel(modulation);
      Slm flat = bent;
      flat.effects = {};
      flat.own_effects.clear();
      const Field field = smooth_field(bent.grid);
      const EncodeParams params{.method = method, .image = image, .target_distances = {0.02}, .iterations = 10};
      const Field of_flat = light_of(encode(field, flat, params), flat);
      Field wanted = field;
      if (image == ImageSide::real_image)
        for (auto& sample : wanted.samples.values) sample = std::conj(sample);
      if (method == Encoding::gerchberg_saxton) wanted = of_flat;  // aims at moduli in a plane
      const double possible = likeness(of_flat, wanted);
      const Hologram known = encode(field, bent, params);
      EXPECT_EQ(known.effects, (std::vector<std::string>{"aberration", "phase-map"}));
      EXPECT_GT(likeness(light_of(known, bent), wanted), least * possible) << int(method) << " " << int(image);
      EncodeParams ignorant = params;
      ignorant.effects = {"none"};
      EXPECT_LT(likeness(light_of(encode(field, bent, ignorant), bent), wanted), 0.5 * possible) << int(method);
    }
}

TEST(KnownPanel, ACorrectionOfTheVendorIsTheNegativeOfAnError) {
  // The vendor's map is added to a hologram's levels: that is what a phase map of negative range does.
  Slm slm = make_panel(side, side);
  const Array2D<float> greys = map_of(slm.grid, [](double x, double y) { return std::floor(100 + 90 * x * y); });
  Array2D<float> map = greys;
  for (float& value : map.values) value *= float(-2 * pi / 256);
  const Field field = smooth_field(slm.grid);
  const Hologram plain = encode(field, slm, {});
  slm.effects.phase_map = std::make_shared<const Array2D<float>>(map);
  slm.own_effects = {"phase-map"};
  const Hologram corrected = encode(field, slm, {});
  for (size_t i = 0; i < greys.size(); ++i) {
    const int expected = (plain.level.values[i] + int(greys.values[i])) % 256;
    EXPECT_LE(std::abs(std::remainder(double(corrected.level.values[i] - expected), 256)), 1)
        << i;  // rounding of a half
  }
}

TEST(KnownPanel, UnevenLightIsCompensatedByEncodersOfModuli) {
  for (const auto& [method, modulation, least] : {MethodCase{Encoding::amplitude, Modulation::amplitude, 0.99999},
                                                  MethodCase{Encoding::complex, Modulation::complex, 0.99999},
                                                  MethodCase{Encoding::double_phase, Modulation::phase, 0.995},
                                                  MethodCase{Encoding::error_diffusion, Modulation::phase, 0.96},
                                                  MethodCase{Encoding::off_axis, Modulation::amplitude, 0.98}}) {
    Slm slm = make_panel(side, side, 65536);
    slm.modulation = modulation;
    const Field field = smooth_field(slm.grid);
    const Field wanted = light_of(encode(field, slm, {.method = method}), slm);
    slm.effects.light_map =
        std::make_shared<const Array2D<float>>(map_of(slm.grid, [](double x, double) { return 1 - 0.8 * x * x; }));
    slm.own_effects = {"light-map"};
    const EncodeParams ignorant{.method = method, .effects = {"none"}};
    const double before = likeness(light_of(encode(field, slm, ignorant), slm), wanted);
    const Hologram known = encode(field, slm, {.method = method});
    EXPECT_EQ(known.effects, slm.own_effects);
    const double after = likeness(light_of(known, slm), wanted);
    EXPECT_GT(after, least) << int(method);
    EXPECT_GT(after, before) << int(method);
  }
}

}  // namespace
}  // namespace holotrace
