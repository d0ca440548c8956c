#include <cmath>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/diffraction_orders.h"
#include "support/panels.h"

// Efficiencies are fractions of the light on the panel (1 W/m²), closed_forms.md section 3.

namespace holotrace {
namespace {

TEST(Show, FlatPanelSendsTheSquareOfItsFillFactorIntoOrderZero) {
  struct Case {
    double fill_factor, order_00, order_10;
  };
  for (const Case& c : {Case{0.87, 0.757, 0.00388}, Case{0.93, 0.865, 0.00118}, Case{1, 1, 0}}) {
    const Slm slm = make_panel(8, 8, 256, c.fill_factor);
    const Field f = show(make_hologram(slm, Modulation::phase, [](int) { return 0; }), slm, {.subpixels = 5});
    const double w = std::sqrt(c.fill_factor), first = w * w * sinc(w) * sinc(w) * w * w;
    EXPECT_NEAR(efficiency_of(f, 0), c.fill_factor * c.fill_factor, efficiency_tolerance);
    EXPECT_NEAR(efficiency_of(f, 0), c.order_00, 5e-4);                 // the digits that closed_forms.md prints
    EXPECT_NEAR(efficiency_of(f, 8), first, efficiency_tolerance);      // order (1, 0): one cycle per pixel
    EXPECT_NEAR(efficiency_of(f, 8), c.order_10, 5e-6);                 // to the digits printed there
    EXPECT_NEAR(efficiency_of(f, 0, -8), first, efficiency_tolerance);  // the orders are equal in x and y
    EXPECT_NEAR(efficiency_of(f, 16, 8), std::pow(w * w * sinc(2 * w) * sinc(w), 2), efficiency_tolerance);
  }
}

TEST(Show, GratingAtNyquistIsRolledOff) {
  struct Case {
    double fill_factor, efficiency;
  };
  for (const Case& c : {Case{1, 0.4053}, Case{0.93, 0.4344}, Case{0.87, 0.4607}}) {
    const Slm slm = make_panel(16, 4, 2, c.fill_factor);
    const Field f = show(make_hologram(slm, Modulation::phase, [](int i) { return i % 2; }), slm, {.subpixels = 3});
    // Along y the panel is flat and has F of the light in order 0, along x w²·sinc²(w/2).
    const double roll_off = std::pow(sinc(std::sqrt(c.fill_factor) / 2), 2);
    for (int side : {-8, 8})
      EXPECT_NEAR(efficiency_of(f, side), c.fill_factor * c.fill_factor * roll_off, efficiency_tolerance);
    EXPECT_NEAR(roll_off, c.efficiency, 5e-5);
  }
}

TEST(Show, OneSamplePerPixelIsOrderZeroWithItsRollOff) {
  const Slm slm = make_panel(16, 4, 2);
  const Field f = show(make_hologram(slm, Modulation::phase, [](int i) { return i % 2; }), slm, {});
  // (−1)ⁱ is a wave at Nyquist: its one bin gets the mean of both signs, sinc(1/2).
  for (int i = 0; i < 16; ++i) EXPECT_NEAR(f.samples(0, i).real(), (i % 2 ? -1 : 1) * sinc(0.5), efficiency_tolerance);
}

TEST(Show, BlazedGratingOfPixelsHasTheOrdersOfItsPixels) {
  // P pixels per period: orders m = 1 + qP with sinc²(m/P) and no other.
  for (int period : {2, 3, 4, 8, 16, 32, 64}) {
    const Slm slm = make_panel(period == 3 ? 48 : 64, 4, period);
    const Hologram h = make_hologram(slm, Modulation::phase, [&](int i) { return i % period; });
    const Field f = show(h, slm, {.subpixels = 9});
    const int cycles = slm.grid.nx / period, highest = 9 * period / 2;
    for (int m = -highest + 1; m < highest; ++m) {
      const double expected = (m - 1) % period == 0 ? std::pow(sinc(double(m) / period), 2) : 0;
      EXPECT_NEAR(efficiency_of(f, m * cycles), expected, efficiency_tolerance)
          << "period " << period << ", order " << m;
    }
  }
}

TEST(Show, RampThatTurnsTooFarLosesLightToOrderZero) {
  // A wave shorter than the design wavelength gets 2π(1+e) per turn: η₁ = sinc²(e), η₀ = sinc²(1+e). With P steps the
  // sum over a period is a Dirichlet kernel instead, times the step's own spectrum sinc²(m/P).
  const int steps = 256;
  const double e = 0.05;
  Slm slm = make_panel(steps, 2, steps);
  const Hologram h = make_hologram(slm, Modulation::phase, [](int i) { return i; });
  const Field f = show(h, slm, {.subpixels = 3, .wavelength = test_wavelength / (1 + e)});
  for (int m : {-1, 0, 1, 2}) {
    const double a = 1 + e - m, dirichlet = std::sin(pi * a) / (steps * std::sin(pi * a / steps));
    EXPECT_NEAR(efficiency_of(f, m), std::pow(dirichlet * sinc(double(m) / steps), 2), efficiency_tolerance) << m;
  }
  EXPECT_NEAR(efficiency_of(f, 1), 0.99180, 1e-4);  // a smooth ramp: π²/3P² = 5e-5 away
  EXPECT_NEAR(efficiency_of(f, 0), 0.00225, 1e-5);

  // The same stretch if the panel's design wavelength is changed instead of the light.
  slm.design_wavelength = test_wavelength * (1 + e);
  EXPECT_NEAR(efficiency_of(show(h, slm, {.subpixels = 3}), 1), efficiency_of(f, 1), efficiency_tolerance);
}

TEST(Show, BinaryPhaseSplitsByItsDepth) {
  for (int depth : {1, 2, 3, 4}) {  // ψ = 2π·depth/8
    const Slm slm = make_panel(32, 2, 8);
    const Hologram h = make_hologram(slm, Modulation::phase, [&](int i) { return i / 4 % 2 * depth; });
    const Field f = show(h, slm, {.subpixels = 3});
    const double psi = 2 * pi * depth / 8, first = 4 / (pi * pi) * std::pow(std::sin(psi / 2), 2);
    EXPECT_NEAR(efficiency_of(f, 0), std::pow(std::cos(psi / 2), 2), efficiency_tolerance);
    for (int side : {-4, 4})
      EXPECT_NEAR(efficiency_of(f, side), first, efficiency_tolerance);  // 4 periods on the panel
  }
}

TEST(Show, TextbookGratings) {
  const int period = 32, nx = 128, cycles = nx / period, levels = 65536;
  const Slm slm = make_panel(nx, 2, levels);
  const double pixel = std::pow(sinc(1.0 / period), 2);  // a staircase of pixels instead of the smooth curve
  const ShowParams params{.subpixels = 3};
  const auto angle = [&](int i) { return 2 * pi * i / period; };

  const auto sine_amplitude = [&](int i) { return int(std::lround((levels - 1) * (0.5 + 0.5 * std::cos(angle(i))))); };
  EXPECT_NEAR(efficiency_of(show(make_hologram(slm, Modulation::amplitude, sine_amplitude), slm, params), cycles),
              0.0625 * pixel, efficiency_tolerance);  // 6.25 % = (1/4)²

  const auto binary_amplitude = [&](int i) { return i % period < period / 2 ? levels - 1 : 0; };
  EXPECT_NEAR(efficiency_of(show(make_hologram(slm, Modulation::amplitude, binary_amplitude), slm, params), cycles),
              1 / (pi * pi), efficiency_tolerance);  // 10.13 %, exact: the edges fall between pixels

  // J₁²(δ) is largest, 33.86 %, at δ = 1.8412, the first zero of J₁'. A level is 2π/65536 = 1e-4 rad.
  const double delta = 1.8412;
  const auto sine_phase = [&](int i) {
    return (int(std::lround(levels * delta * std::sin(angle(i)) / (2 * pi))) + levels) % levels;
  };
  const double efficiency = efficiency_of(show(make_hologram(slm, Modulation::phase, sine_phase), slm, params), cycles);
  EXPECT_NEAR(efficiency, std::pow(std::cyl_bessel_j(1, delta), 2) * pixel, 1e-5);
  EXPECT_NEAR(efficiency / pixel, 0.3386, 5e-5);
}

TEST(Show, PixelsStandWhereTheGridSays) {
  // One lit pixel: the light is symmetric around it. On a periodic panel the centre is a circular mean.
  for (int n : {1, 2, 3, 4, 5}) {
    const Slm slm = make_panel(12, 10, 2);
    Hologram h = make_hologram(slm, Modulation::amplitude, [](int) { return 0; });
    const int row = 2, column = 7;
    h.level(row, column) = 1;
    const Field f = show(h, slm, {.subpixels = n});
    std::complex<double> mean_x = 0, mean_y = 0;
    for (int j = 0; j < f.grid.ny; ++j)
      for (int i = 0; i < f.grid.nx; ++i) {
        const double light = std::norm(f.samples(j, i));
        mean_x += light * std::polar(1.0, 2 * pi * f.grid.x(i) / f.grid.width());
        mean_y += light * std::polar(1.0, 2 * pi * f.grid.y(j) / f.grid.height());
      }
    EXPECT_NEAR(std::arg(mean_x) / (2 * pi) * f.grid.width(), slm.grid.x(column), 1e-6 * test_pitch) << n;
    EXPECT_NEAR(std::arg(mean_y) / (2 * pi) * f.grid.height(), slm.grid.y(row), 1e-6 * test_pitch) << n;
  }
}

// The field at a point by the definition in show.h, as a sum of plane waves: frequencies up to n/2 cycles per pixel,
// half of it at n/2 itself.
std::complex<double> slow_show(const Array2D<std::complex<double>>& panel, int n, double w, double x, double y) {
  const auto waves = [&](int pixels, double position, const auto& pixel_position) {
    std::vector<std::complex<double>> weight_of_pixel(static_cast<size_t>(pixels));
    for (int p = 0; p < pixels; ++p)
      for (int k = -(n * pixels / 2); 2 * k <= n * pixels; ++k) {
        const double f = double(k) / pixels, half = 2 * std::abs(k) == n * pixels ? 0.5 : 1;
        weight_of_pixel[size_t(p)] +=
            half * w * sinc(w * f) * std::polar(1.0 / pixels, 2 * pi * f * (position - pixel_position(p)));
      }
    return weight_of_pixel;
  };
  const auto along_x = waves(panel.nx, x, [&](int i) { return i - (panel.nx - 1) / 2.0; });
  const auto along_y = waves(panel.ny, y, [&](int j) { return (panel.ny - 1) / 2.0 - j; });
  std::complex<double> sum = 0;
  for (int j = 0; j < panel.ny; ++j)
    for (int i = 0; i < panel.nx; ++i) sum += panel(j, i) * along_x[size_t(i)] * along_y[size_t(j)];
  return sum;
}

TEST(Show, IsTheBandLimitedSumOfItsPixels) {
  CounterRandom random(2, 0, 0);
  for (const auto& [nx, ny] : {std::pair{6, 4}, {5, 3}, {4, 7}, {1, 1}})
    for (int n : {1, 2, 3, 4, 5}) {
      const Slm slm = make_panel(nx, ny, 256, 0.8);
      Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 0; });
      Array2D<std::complex<double>> panel(ny, nx);
      for (size_t i = 0; i < panel.size(); ++i) {
        h.level.values[i] = uint16_t(256 * random.uniform());
        panel.values[i] = std::polar(1.0, 2 * pi * h.level.values[i] / 256);
      }
      const Field f = show(h, slm, {.subpixels = n});
      for (int j = 0; j < f.grid.ny; ++j)
        for (int i = 0; i < f.grid.nx; ++i) {
          const std::complex<double> expected =
              slow_show(panel, n, std::sqrt(0.8), f.grid.x(i) / test_pitch, f.grid.y(j) / test_pitch);
          // Single precision: an FFT of few samples of modulus 1.
          EXPECT_LT(std::abs(std::complex<double>(f.samples(j, i)) - expected), 2e-6) << nx << " × " << ny << ", " << n;
        }
    }
}

TEST(Show, ManySamplesPerPixelShowLitSquares) {
  // 64 samples per pixel: the amplitude is 1 inside the lit square and 0 in the gap, except for Gibbs's ringing, which
  // at the middle of both is below 1/(π·n·w/2) = 1 %.
  const double w = 0.5;
  const Slm slm = make_panel(4, 4, 2, w * w);
  const Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 0; });
  const Field f = show(h, slm, {.subpixels = 65});
  const int middle = 32;
  EXPECT_NEAR(f.samples(middle, middle).real(), 1, 0.02);       // both axes ring
  EXPECT_NEAR(f.samples(middle, 65).real(), 0, 0.02);           // half a pixel to the right
  EXPECT_NEAR(f.samples(middle, middle + 10).real(), 1, 0.06);  // 10/65 < w/2
}

TEST(Show, PowerIsThatOfTheOrdersHeld) {
  const Slm slm = make_panel(16, 12, 256, 0.9);
  Hologram h = make_hologram(slm, Modulation::phase, [](int i) { return i * i * 37 % 256; });
  Heard heard;
  const Field f = show(h, slm, {.subpixels = 3, .irradiance = 7}, heard.observer());
  const double panel = 16 * 12 * test_pitch * test_pitch;
  EXPECT_NEAR(heard.number("power_in"), 7 * panel, 1e-12 * panel);  // E·area
  EXPECT_NEAR(heard.number("power_out"), power(f), 1e-6 * panel);
  EXPECT_NEAR(heard.number("efficiency"), power(f) / (7 * panel), 1e-9);
  EXPECT_LT(heard.number("efficiency"), 0.9);  // at most the light that the lit area passes
  // More orders hold more light, up to the fill factor F = w²: an axis holds w less the tail of (sin πwf/πf)² beyond
  // ±n/2, at most 4/(π²n).
  show(h, slm, {.subpixels = 41}, heard.observer());
  const double w = std::sqrt(0.9), missing = 0.9 - heard.number("efficiency");
  EXPECT_GT(missing, 0);
  EXPECT_LT(missing, 2 * w * 4 / (pi * pi * 41));
}

TEST(Show, CarriesWhatABenchMustKnow) {
  const Slm slm = make_panel(6, 4, 2);
  Hologram h = make_hologram(slm, Modulation::amplitude, [](int) { return 1; });
  h.image = ImageSide::real_image;
  h.filter = SpectralFilter{1, 2, 3, 4};
  const Field f = show(h, slm, {.subpixels = 3, .wavelength = 633e-9});
  EXPECT_EQ(f.grid, (Grid{18, 12, test_pitch / 3}));
  EXPECT_EQ(f.image, ImageSide::real_image);
  EXPECT_EQ(f.filter, h.filter);
  EXPECT_EQ(f.wavelength, 633e-9);
  EXPECT_EQ(f.z, 0);
}

TEST(Show, StopFollowsTheOrderUnderTiltedLight) {
  // Order 1 of a period of 4 pixels is 16 cycles over 64 pixels; tilts of 24 and −20 whole cycles move it by these.
  // With 5 samples per pixel it stays within the band of 160 cycles, with the same light around it.
  const Slm slm = make_panel(64, 64, 4);
  Hologram h = make_hologram(slm, Modulation::phase, [](int i) { return i % 4; });
  const double width = slm.grid.width(), cycle = 1 / width;
  h.filter = SpectralFilter{16 * cycle, 0, 4 * cycle, 4 * cycle};
  const auto passed = [&](const ShowParams& params) {
    const Field f = show(h, slm, params);
    Heard heard;
    apply_order_stop(f, *f.filter, 0, heard.observer());
    return heard.number("filter_power") * energy(f.samples.values.data(), f.samples.size());
  };
  const ShowParams axial{.subpixels = 5};
  ShowParams tilted = axial;
  tilted.tilt_x = std::asin(24 * test_wavelength / width);
  tilted.tilt_y = std::asin(-20 * test_wavelength / width);
  EXPECT_GT(passed(axial), 0.5 * 320 * 320);  // it has sinc²(1/4) = 0.81 of the light
  EXPECT_NEAR(passed(tilted) / passed(axial), 1, 1e-4);
  // A state's own direction, for an extended source, moves the light and not the stop.
  const Field spread = show(h, slm, axial, IlluminationState{test_wavelength, tilted.tilt_x, tilted.tilt_y});
  EXPECT_EQ(spread.filter, h.filter);
}

TEST(Show, IsOfAPanelThatModulatesAsTheHologramDoes) {
  const auto panel_of = [](Modulation modulation) {
    Slm slm = make_panel(8, 4, 16);
    slm.modulation = modulation;
    return slm;
  };
  const auto made_for = [&](Modulation modulation) {
    Hologram h = make_hologram(panel_of(modulation), modulation, [](int) { return 1; });
    h.modulus_level = h.level;
    return h;
  };
  EXPECT_EQ(error_of([&] { show(made_for(Modulation::phase), panel_of(Modulation::amplitude), {}); }),
            "expected a hologram of amplitudes for the amplitude panel \"test\", got one of phases; encode with "
            "\"amplitude\" or \"off-axis\", or show it on a phase panel");
  for (const Modulation alone : {Modulation::phase, Modulation::amplitude})
    EXPECT_EQ(
        error_of([&] { show(made_for(Modulation::complex), panel_of(alone), {}); }),
        "expected a hologram of phase or of amplitude alone for the panel \"test\", which has no more, got one of "
        "both; encode with \"double-phase\" or \"off-axis\", or show it on a panel whose modulation is complex");
  for (const Modulation any : {Modulation::phase, Modulation::amplitude, Modulation::complex}) {
    Heard heard;
    show(made_for(any), panel_of(any), {}, heard.observer());
    EXPECT_TRUE(heard.warnings.empty());
  }
  // Amplitudes on a phase panel: warned of here, but not if encode has warned of the hologram's own panel.
  Heard here, before;
  Hologram h = made_for(Modulation::amplitude);
  show(h, panel_of(Modulation::phase), {}, here.observer());
  ASSERT_EQ(here.warnings.size(), 1u);
  EXPECT_EQ(here.warnings[0],
            "the SLM \"test\" modulates phase and the hologram amplitude: it is shown as if behind a crossed polariser "
            "that turns phase into amplitude");
  h.slm = panel_of(Modulation::phase);
  show(h, panel_of(Modulation::phase), {}, before.observer());
  EXPECT_TRUE(before.warnings.empty());
}

TEST(Show, TellsWhereLevelsAllowForOtherEffects) {
  Slm slm = make_panel(8, 4, 16);
  slm.effects.crosstalk = 0.2;
  slm.effects.gap_amplitude = 0.5;
  slm.effects.flicker = 0.02;
  Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 1; });
  const auto warnings = [&](const std::vector<std::string>& allowed, const std::vector<std::string>& on) {
    h.effects = allowed;
    Heard heard;
    show(h, slm, {.effects = on}, heard.observer());
    return heard.warnings;
  };
  EXPECT_TRUE(warnings({}, {"all"}).empty());
  EXPECT_TRUE(warnings({"crosstalk", "gaps"}, {"all"}).empty());  // no level can compensate flicker
  EXPECT_EQ(warnings({"crosstalk"}, {"crosstalk", "gaps"}),
            (std::vector<std::string>{"the hologram compensates crosstalk but not gaps, which are modelled on the SLM "
                                      "\"test\"; sgd compensates all effects but flicker"}));
  EXPECT_EQ(warnings({"crosstalk", "gaps"}, {"gaps"}),
            (std::vector<std::string>{"the hologram compensates crosstalk, which is not modelled on the SLM \"test\"; "
                                      "name crosstalk in [show] effects, or encode without"}));
  EXPECT_EQ(warnings({"crosstalk"}, {"gaps"}).size(), 2u);
}

TEST(Show, TellsOfAPanelThatWasMeasuredAnew) {
  Slm slm = make_panel(8, 4, 4);
  slm.effects.calibration = {{0, 1}, {1.5, 1}, {3, 1}, {4.5, 1}};
  slm.effects.aberration = {{2, 0, 0.3}};
  Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 1; });
  h.effects = {"calibration", "aberration"};
  const auto warnings = [&](const Slm& on) {
    Heard heard;
    show(h, on, {.effects = {"all"}}, heard.observer());
    return heard.warnings;
  };
  h.slm = slm;
  h.slm->effects.calibration[3].phase = 4.54;  // less than 0.05 rad
  EXPECT_TRUE(warnings(slm).empty());
  h.slm->effects.calibration[3].phase = 4.6;
  EXPECT_EQ(warnings(slm),
            (std::vector<std::string>{"the hologram was made for another calibration than the SLM \"test\" has; "
                                      "encode it again for this panel"}));
  h.slm->effects = {};
  h.effects.clear();
  EXPECT_EQ(warnings(slm),
            (std::vector<std::string>{"the hologram was made for another calibration and aberration than the SLM "
                                      "\"test\" has; encode it again for this panel"}));
  Slm ideal = slm;
  ideal.effects = {};
  EXPECT_TRUE(warnings(ideal).empty());
  ideal.phase_range = 2.2 * pi;
  EXPECT_EQ(warnings(ideal),
            (std::vector<std::string>{"the hologram was made for another phase range than the SLM \"test\" has; "
                                      "encode it again for this panel"}));
  // The same phases at the wavelength of the hologram.
  ideal.design_wavelength = h.wavelength / 1.1;
  EXPECT_TRUE(warnings(ideal).empty());
  h.slm.reset();  // nothing is known
  EXPECT_TRUE(warnings(slm).empty());
}

TEST(Show, SaysWhatIsWrong) {
  const Slm slm = make_panel(8, 4, 16);
  const Hologram good = make_hologram(slm, Modulation::phase, [](int) { return 0; });
  const auto error = [&](const Hologram& h, const Slm& s, const ShowParams& p) {
    return error_of([&] { show(h, s, p); });
  };
  EXPECT_EQ(error(good, slm, {.subpixels = 0}), "expected a whole number from 1 to 65536 for \"subpixels\", got 0");
  EXPECT_EQ(error(good, slm, {.irradiance = -1}), "expected a number of 0 or more for \"irradiance\", got -1");
  EXPECT_EQ(
      error(good, slm, {.beam_radius = 1e-3}),
      "expected a beam radius only with Gaussian light, got 1 mm; set light to gaussian, or leave out beam_radius");
  EXPECT_EQ(error(good, slm, {.light = Wavefront::gaussian, .source_distance = -0.1, .beam_radius = 1e-3}),
            "expected a source distance only with spherical light, got -100 mm; set light to spherical, or leave "
            "out source_distance");
  EXPECT_EQ(error(good, make_panel(8, 4, 16, 1.2), {}), "expected a fill factor in (0, 1], got 1.2");
  EXPECT_EQ(error(good, make_panel(8, 4, 1), {}), "expected 2 to 65536 levels, got 1");
  EXPECT_EQ(
      error(good, make_panel(9, 4, 16), {}),
      "expected a hologram of 9 × 4 samples at 8 µm, the pixels of the SLM \"test\", got 8 × 4 at 8 µm; compute it "
      "on the SLM's grid or name the SLM it was computed for");
  Hologram bad = good;
  bad.level(2, 5) = 16;
  EXPECT_EQ(error(bad, slm, {}), "expected levels below 16, got 16 at row 2, column 5");
  bad = good;
  bad.levels = 1;
  EXPECT_EQ(error(bad, slm, {}), "expected 2 to 65536 levels, got 1");
  EXPECT_NE(error(good, slm, {.subpixels = 60000})
                .find("expected a panel of 8 × 4 pixels at 60000 samples per "
                      "pixel and axis to fit in memory, but it needs "),
            std::string::npos);
}

}  // namespace
}  // namespace holotrace
