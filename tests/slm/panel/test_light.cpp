#include <cmath>

#include "holotrace/base/cycles.h"
#include "holotrace/slm/panel/illumination.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/panels.h"

// The light on the panel: its shape, direction and coherence.

namespace holotrace {
namespace {

Hologram flat(const Slm& slm) {
  return make_hologram(slm, Modulation::phase, [](int) { return 0; });
}

// Centroid of the light of a field, and its rms width in x [m].
struct Spot {
  double x = 0, y = 0, width = 0, power = 0;
};
Spot spot_of(const Field& f) {
  Spot s;
  double square = 0;
  for (int j = 0; j < f.grid.ny; ++j)
    for (int i = 0; i < f.grid.nx; ++i) {
      const double light = std::norm(f.samples(j, i)), x = f.grid.x(i);
      s.power += light;
      s.x += light * x;
      s.y += light * f.grid.y(j);
      square += light * x * x;
    }
  s.x /= s.power;
  s.y /= s.power;
  s.width = std::sqrt(square / s.power - s.x * s.x);
  return s;
}

TEST(Light, TiltedMovesTheImageByItsAngle) {
  // A Gaussian beam, so that the panel's edges do not matter. Its centre moves by z·tan α, in x and y by the ray's
  // slope sin αx/cos, cos = √(1 − sin²αx − sin²αy). Its angles spread by λ/πw = 1.1 mrad, changing the mean by 1e-6.
  const Slm slm = make_panel(256, 256);
  const double w = 0.15e-3, z = 0.05;
  ShowParams params{.light = Wavefront::gaussian, .tilt_x = 0.01, .tilt_y = -0.006, .beam_radius = w};
  const Field shown = show(flat(slm), slm, params);
  EXPECT_NEAR(spot_of(shown).x, 0, 1e-9);
  const Spot spot = spot_of(propagate(shown, z));
  const double sx = std::sin(0.01), sy = std::sin(-0.006), cosine = std::sqrt(1 - sx * sx - sy * sy);
  // A field of single precision: 1e-5 of the window of 2 mm, below a hundredth of a pixel.
  EXPECT_NEAR(spot.x, z * sx / cosine, 2e-8);
  EXPECT_NEAR(spot.y, z * sy / cosine, 2e-8);
}

TEST(Light, TiltedTurnsEverySampleByItsPlace) {
  const Slm slm = make_panel(6, 4);
  for (const int n : {1, 3}) {
    ShowParams params{.subpixels = n, .irradiance = 4, .tilt_x = 0.02, .tilt_y = 0.01};
    Heard heard;
    const Field f = show(flat(slm), slm, params, heard.observer());
    for (int j = 0; j < f.grid.ny; ++j)
      for (int i = 0; i < f.grid.nx; ++i) {
        const double cycles = (std::sin(0.02) * f.grid.x(i) + std::sin(0.01) * f.grid.y(j)) / test_wavelength;
        EXPECT_LT(std::abs(std::complex<double>(f.samples(j, i)) - 2.0 * cis_cycles(cycles)), 2e-6);
      }
    EXPECT_NEAR(heard.number("efficiency"), 1, 1e-6);
  }
}

TEST(Light, SphericalFocusesAFlatPanelAtItsCentre) {
  // Light that converges to a point at R, off the axis: all pixels are in phase there. Rayleigh–Sommerfeld, where R is
  // much longer than λ: u = (1/iλ)·∫ √E·(R/r)·(R/r)/r dA = √E·R²/(iλ)·∫ r⁻³ dA, along the axis √E·R·Ω/iλ.
  const int pixels = 96;
  const Slm slm = make_panel(pixels, pixels);
  const double distance = 0.03;
  ShowParams params{.subpixels = 3, .irradiance = 2, .light = Wavefront::spherical, .source_distance = -distance};
  Field f = show(flat(slm), slm, params);
  std::complex<double> sum = 0;
  double solid = 0;
  for (int j = 0; j < f.grid.ny; ++j)
    for (int i = 0; i < f.grid.nx; ++i) {
      const double rho2 = std::pow(f.grid.x(i), 2) + std::pow(f.grid.y(j), 2),
                   r = std::sqrt(rho2 + distance * distance);
      const double area = f.grid.pitch * f.grid.pitch;
      sum += std::complex<double>(f.samples(j, i)) * cis_cycles(rho2 / (r + distance) / test_wavelength) * distance /
             (r * r) * area;
      solid += std::pow(distance, 2) / (r * r * r) * area;
    }
  // Samples of 1e-7, and phases within 1e-7 of a cycle.
  EXPECT_NEAR(std::abs(sum) / (std::sqrt(2.0) * solid), 1, 1e-5);
  EXPECT_NEAR(std::arg(sum), 0, 1e-5);

  // The propagator finds that focus: |u| = √E·S²/(λR) except for an obliquity of (S/R)²/6 = 1e-4, at one sample of a
  // sinc² whose first zero is at λR/S = 20 µm, 8 samples away: half a sample costs (π/16)²/6 per axis at most.
  const Field focus = propagate(f, distance);
  double brightest = 0;
  for (const auto& u : focus.samples.values) brightest = std::max(brightest, double(std::abs(u)));
  const double side = pixels * test_pitch;
  EXPECT_NEAR(brightest / (std::sqrt(2.0) * side * side / (test_wavelength * distance)), 1, 0.015);

  // Diverging light is its conjugate.
  params.source_distance = distance;
  const Field diverging = show(flat(slm), slm, params);
  for (size_t k = 0; k < f.samples.size(); ++k)
    EXPECT_LT(std::abs(diverging.samples.values[k] - std::conj(f.samples.values[k])), 2e-6);
}

TEST(Light, GaussianIsTheBeamItSays) {
  // On the panel exp(−ρ²/w²); its power is E·πw²/2 if the panel holds all of it.
  const Slm slm = make_panel(128, 128);
  const double w = 0.12e-3;
  Heard heard;
  ShowParams params{.irradiance = 5, .light = Wavefront::gaussian, .beam_radius = w};
  const Field f = show(flat(slm), slm, params, heard.observer());
  EXPECT_NEAR(f.samples(10, 64).real(),
              std::sqrt(5.0) * std::exp(-(std::pow(f.grid.x(64), 2) + std::pow(f.grid.y(10), 2)) / (w * w)), 1e-6);
  // The panel's edge is at 4.3 w: e^(−2·4.3²) = 1e-16 lies beyond. The sum over samples is exact for such a beam.
  EXPECT_NEAR(heard.number("power_in") / (5 * pi * w * w / 2), 1, 1e-6);
  EXPECT_NEAR(heard.number("efficiency"), 1, 1e-6);
  // It spreads as a Gaussian beam: w(z) = w√(1 + (z/z_R)²), z_R = πw²/λ; rms width w/2.
  const double z = 0.05, rayleigh = pi * w * w / test_wavelength;
  EXPECT_NEAR(spot_of(propagate(f, z)).width / (w / 2 * std::sqrt(1 + std::pow(z / rayleigh, 2))), 1, 1e-4);
}

TEST(Light, SaysWhatSamplesCannotHold) {
  const Slm slm = make_panel(64, 64);
  const auto error = [&](const ShowParams& params) { return error_of([&] { show(flat(slm), slm, params); }); };
  EXPECT_EQ(error({.tilt_x = 0.05}),
            "expected illumination at an angle below 1.905°, the largest that samples of 8 µm can represent at 532 nm, "
            "got 2.865°; use more subpixels, or less tilt or curvature");
  EXPECT_EQ(error({.subpixels = 2, .tilt_x = 0.05}), "no error");
  EXPECT_EQ(error({.light = Wavefront::spherical}),
            "expected a source distance other than 0 m for spherical light, got 0 m; below 0 m it converges");
  EXPECT_EQ(error({.light = Wavefront::gaussian}), "expected a beam radius above 0 m for Gaussian light, got 0 m");
  EXPECT_EQ(error({.tilt_y = 1.6}), "expected an angle above -90 deg and below 90 deg for \"tilt_y\", got 91.6732 deg");
}

// --- coherence ----------------------------------------------------------------------------------

TEST(IlluminationStates, AreOneForCoherentLight) {
  const Slm slm = make_panel(4, 4);
  const std::vector<IlluminationState> all =
      illumination_states(slm, {.tilt_x = 0.1, .illumination_states = 7}, 500e-9);
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].wavelength, 500e-9);
  EXPECT_EQ(all[0].tilt_x, 0.1);
  EXPECT_EQ(all[0].weight, 1);
}

struct Spread {
  double mean = 0, rms = 0;
};
template <class Value>
Spread spread_of(const std::vector<IlluminationState>& all, const Value& value) {
  Spread s;
  for (const IlluminationState& m : all) s.mean += m.weight * value(m);
  for (const IlluminationState& m : all) s.rms += m.weight * std::pow(value(m) - s.mean, 2);
  s.rms = std::sqrt(s.rms);
  return s;
}

TEST(IlluminationStates, HaveTheSpreadOfSpectrumSourceAndRipple) {
  // A Gaussian of σ = FWHM/2.3548, a disc of diameter α with the rms α/4 per axis, a sinusoid of rms 1/√2; all
  // uncorrelated. 1024 even points have an error of 1e-3 (for the tails of the Gaussian 1/N·ln N = 7e-3).
  Slm slm = make_panel(4, 4);
  slm.effects.flicker = 0.1;
  const std::vector<IlluminationState> all = illumination_states(
      slm, {.tilt_x = 0.01, .bandwidth = 10e-9, .source_angle = 0.004, .illumination_states = 1024}, 500e-9);
  ASSERT_EQ(all.size(), 1024u);
  const auto wavelength = [](const IlluminationState& m) { return m.wavelength; };
  const auto x = [](const IlluminationState& m) { return m.tilt_x; };
  const auto y = [](const IlluminationState& m) { return m.tilt_y; };
  const auto ripple = [](const IlluminationState& m) { return m.flicker; };
  EXPECT_NEAR(spread_of(all, wavelength).mean, 500e-9, 1e-11);
  EXPECT_NEAR(spread_of(all, wavelength).rms, 10e-9 / 2.354820, 0.01 * 4.25e-9);
  EXPECT_NEAR(spread_of(all, x).mean, 0.01, 2e-5);
  EXPECT_NEAR(spread_of(all, x).rms, 0.001, 1e-5);
  EXPECT_NEAR(spread_of(all, y).mean, 0, 2e-5);
  EXPECT_NEAR(spread_of(all, y).rms, 0.001, 1e-5);
  EXPECT_NEAR(spread_of(all, ripple).mean, 0, 0.01);
  EXPECT_NEAR(spread_of(all, ripple).rms, std::sqrt(0.5), 0.01);
  const auto uncorrelated = [&](const auto& a, const auto& b) {
    const Spread sa = spread_of(all, a), sb = spread_of(all, b);
    double sum = 0;
    for (const IlluminationState& m : all) sum += m.weight * (a(m) - sa.mean) * (b(m) - sb.mean);
    EXPECT_NEAR(sum / (sa.rms * sb.rms), 0, 0.02);
  };
  uncorrelated(wavelength, x);
  uncorrelated(wavelength, y);
  uncorrelated(wavelength, ripple);
  uncorrelated(x, y);
  uncorrelated(x, ripple);
  uncorrelated(y, ripple);
}

TEST(IlluminationStates, AnyNumberHasTheMiddleOfSpectrumAndSource) {
  // Means to a hundred roundings: 100·2.2e-16 times 500 nm is 1.1e-20 m, times 0.02 rad 4.4e-16 rad.
  const Slm slm = make_panel(4, 4);
  for (const int count : {1, 2, 3, 5, 16, 100}) {
    const ShowParams params{
        .tilt_x = 0.01, .tilt_y = -0.02, .bandwidth = 10e-9, .source_angle = 0.004, .illumination_states = count};
    const std::vector<IlluminationState> all = illumination_states(slm, params, 500e-9);
    ASSERT_EQ(all.size(), size_t(count));
    EXPECT_NEAR(spread_of(all, [](const IlluminationState& m) { return m.wavelength; }).mean, 500e-9, 1.1e-20) << count;
    EXPECT_NEAR(spread_of(all, [](const IlluminationState& m) { return m.tilt_x; }).mean, 0.01, 4.4e-16) << count;
    EXPECT_NEAR(spread_of(all, [](const IlluminationState& m) { return m.tilt_y; }).mean, -0.02, 4.4e-16) << count;
  }
}

TEST(IlluminationStates, OfAWideSourceBlurAPointByItsAngle) {
  // Every direction of the source makes its own image of the beam, z·tan α away. The mean irradiance is wider by the
  // source's rms, z·α/4 per axis, added in squares.
  const Slm slm = make_panel(192, 192);
  const double w = 0.2e-3, z = 0.1, angle = 6e-3;
  ShowParams params{.light = Wavefront::gaussian, .beam_radius = w, .source_angle = angle, .illumination_states = 32};
  double power = 0, first = 0, second = 0;
  const std::vector<IlluminationState> all = illumination_states(slm, params, test_wavelength);
  for (const IlluminationState& m : all) {
    const Spot s = spot_of(propagate(show(flat(slm), slm, params, m), z));
    power += m.weight;
    first += m.weight * s.x;
    second += m.weight * (s.width * s.width + s.x * s.x);
  }
  const double alone = spot_of(propagate(show(flat(slm), slm, params), z)).width;
  EXPECT_NEAR(power, 1, 1e-12);
  const double blur = std::sqrt(second - first * first - alone * alone);
  // 32 points on the disc have its second moment to some 2 %.
  EXPECT_NEAR(blur / (z * angle / 4), 1, 0.03);
}

TEST(IlluminationStates, OfAWideSpectrumSpreadAnOrderByItsDispersion) {
  // Order 1 of a grating of P pixels leaves at sin θ = λ/(P·p): σ of the wavelength spreads it by z·σ/(P·p).
  const int period = 4;
  Slm slm = make_panel(192, 64, period);
  const Hologram h = make_hologram(slm, Modulation::phase, [&](int i) { return i % period; });
  const double z = 0.02, w = 0.15e-3, bandwidth = 30e-9;
  // An ideal panel at each wavelength: a fixed design wavelength would make the hologram's ramp uneven at the others.
  ShowParams params{.light = Wavefront::gaussian, .beam_radius = w, .bandwidth = bandwidth, .illumination_states = 32};
  double first = 0, second = 0, alone = 0, power = 0;
  for (const IlluminationState& m : illumination_states(slm, params, test_wavelength)) {
    slm.design_wavelength = m.wavelength;
    const Spot s = spot_of(propagate(show(h, slm, params, m), z));
    first += m.weight * s.x * s.power;
    second += m.weight * (s.width * s.width + s.x * s.x) * s.power;
    alone += m.weight * s.width * s.width * s.power;
    power += m.weight * s.power;
  }
  const double mean = first / power, spread = std::sqrt((second - alone) / power - mean * mean);
  const double sigma = bandwidth / 2.354820, cosine = std::cos(std::asin(test_wavelength / (period * test_pitch)));
  EXPECT_NEAR(mean, z * std::tan(std::asin(test_wavelength / (period * test_pitch))), 2e-7);
  // 32 quantiles have 0.985 of the Gaussian's σ: those at (i + ½)/32 miss the tails.
  EXPECT_NEAR(spread / (z * sigma / (period * test_pitch) / std::pow(cosine, 3)), 0.985, 0.01);
}

TEST(IlluminationStates, SayWhatIsWrong) {
  const Slm slm = make_panel(4, 4);
  EXPECT_EQ(error_of([&] { illumination_states(slm, {.bandwidth = -1e-9}, 500e-9); }),
            "expected a length of 0 m or more for \"bandwidth\", got -1 nm");
  EXPECT_EQ(error_of([&] { illumination_states(slm, {.illumination_states = -1}, 500e-9); }),
            "expected a whole number from 0 to 65536 for \"illumination_states\", got -1");
  EXPECT_EQ(error_of([&] { illumination_states(slm, {.bandwidth = 1e-6, .illumination_states = 64}, 500e-9); }),
            "expected a bandwidth much smaller than the wavelength 500 nm, got 1 µm: its spectrum reaches 0 m");
}

}  // namespace
}  // namespace holotrace
