#include <cmath>

#include "holotrace/slm/panel/crosstalk.h"
#include "holotrace/slm/panel/illumination.h"
#include "holotrace/slm/panel/panel_model.h"
#include "holotrace/slm/panel/pixel_expansion.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/slm/panel/static_errors.h"
#include "support/panels.h"

// The panel's effects one by one, each compared with its closed form or a quadrature. Efficiencies are fractions of the
// light on the panel.

namespace holotrace {
namespace {

// --- calibration --------------------------------------------------------------------------------

TEST(Calibration, IsWhatAPixelShows) {
  Slm slm = make_panel(1, 1, 4);
  slm.effects.calibration = {{0, 1}, {1, 0.9}, {2.5, 0.8}, {4, 0.95}};
  for (int level = 0; level < 4; ++level) {
    const Hologram h = make_hologram(slm, Modulation::phase, [&](int) { return level; });
    const CalibrationPoint& point = slm.effects.calibration[size_t(level)];
    const std::complex<double> u(show(h, slm, with_effects({"calibration"}, 1)).samples(0, 0));
    EXPECT_LT(std::abs(u - std::polar(point.amplitude, point.phase)), efficiency_tolerance) << level;
    const std::complex<double> ideal(show(h, slm, with_effects({}, 1)).samples(0, 0));
    EXPECT_LT(std::abs(ideal - std::polar(1.0, 2 * pi * level / 4)), efficiency_tolerance) << level;
  }
  // The pixel delays by a length: at two thirds of the wavelength the phase is 1.5 times as large.
  slm.design_wavelength = test_wavelength;
  const Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 2; });
  ShowParams params = with_effects({"calibration"}, 1);
  params.wavelength = test_wavelength / 1.5;
  EXPECT_LT(std::abs(std::complex<double>(show(h, slm, params).samples(0, 0)) - std::polar(0.8, 2.5 * 1.5)),
            efficiency_tolerance);
}

TEST(Calibration, OfAnAmplitudePanelIsWhatAPixelShows) {
  Slm slm = make_panel(1, 1, 4);
  slm.modulation = Modulation::amplitude;
  slm.effects.calibration = {{0, 0.1}, {0.2, 0.4}, {0.5, 0.8}, {0.9, 1}};
  const auto shown = [&](int level, int levels) {
    Hologram h = make_hologram(slm, Modulation::amplitude, [&](int) { return level; });
    h.levels = levels;
    return std::complex<double>(show(h, slm, with_effects({"calibration"}, 1)).samples(0, 0));
  };
  const auto of_level = [&](size_t level) {
    return std::polar(slm.effects.calibration[level].amplitude, slm.effects.calibration[level].phase);
  };
  for (int level = 0; level < 4; ++level)
    EXPECT_LT(std::abs(shown(level, 4) - of_level(size_t(level))), efficiency_tolerance) << level;
  // Fewer levels spread over the panel's: black and white stay its first and last level.
  EXPECT_LT(std::abs(shown(0, 2) - of_level(0)), efficiency_tolerance);
  EXPECT_LT(std::abs(shown(1, 2) - of_level(3)), efficiency_tolerance);
}

TEST(Calibration, OfARangeAsideOf2PiIsARampOfThatDepth) {
  // A ramp of depth 2π(1+e) from the panel's phase range: η₁ = sinc²(e), with P steps as in RampThatTurnsTooFar….
  const int steps = 256;
  for (const double e : {-0.1, 0.05}) {
    Slm slm = make_panel(steps, 2, steps);
    slm.phase_range = 2 * pi * (1 + e);
    const Field f = show(make_hologram(slm, Modulation::phase, [](int i) { return i; }), slm, with_effects({}));
    EXPECT_NEAR(efficiency_of(f, 1), std::pow(sinc(e), 2), 1e-4);  // π²/3P² = 5e-5 from the smooth ramp's
    EXPECT_NEAR(efficiency_of(f, 0), std::pow(sinc(1 + e), 2), 1e-4);
  }
}

// --- crosstalk ----------------------------------------------------------------------------------

// Order ±1 of a grating 0, π, 0, π, … with a blurred phase: |½∫₀² exp(iφ(x))·exp(−iπx) dx|². φ is the blur of a square
// wave by a Gaussian, as an exact Fourier series: π·(½ + (2/π)·Σ over odd m of sin(πmx)/m·exp(−(πmσ)²/2)).
double blurred_binary_efficiency(double sigma) {
  const int points = 20000;  // the midpoint rule is exact to rounding for a smooth periodic function
  std::complex<double> sum = 0;
  for (int k = 0; k < points; ++k) {
    const double x = 2 * (k + 0.5) / points;
    double wave = 0.5;
    for (int m = 1; m < 2000; m += 2) {
      const double damped = std::exp(-std::pow(pi * m * sigma, 2) / 2);
      wave += 2 / pi * std::sin(pi * m * x) / m * damped;
      if (damped < 1e-12) break;
    }
    sum += std::polar(1.0, pi * wave - pi * x);
  }
  return std::norm(sum / double(points));
}

TEST(Crosstalk, ReachesAllNeighboursThatCount) {
  const LegendrePoints points(6, 1);
  for (const double sigma : {0.05, 0.2, 0.35, 1.0}) {
    const PixelBlur::Taps taps(sigma, 0.95, points.places);
    for (const double place : points.places) {
      const double x = taps.reach + 1 - 0.95 / 2 * std::abs(place);  // to the first one that is left out
      EXPECT_LT(0.5 * std::erfc((x - 0.5) / (std::sqrt(2.0) * sigma)), 3e-7) << sigma;  // 5 σ from its edge
    }
  }
}

TEST(Crosstalk, LowersABinaryGratingAsItsQuadratureSays) {
  const Slm plain = make_panel(16, 4, 2);
  const Hologram h = make_hologram(plain, Modulation::phase, [](int i) { return i % 2; });
  double last = 4 / (pi * pi);  // 0.4053 for a sharp grating
  for (const double sigma : {0.05, 0.1, 0.2, 0.3}) {
    Slm slm = plain;
    slm.effects.crosstalk = sigma;
    const double expected = blurred_binary_efficiency(sigma);
    // 32 points per pixel resolve edges 2σ wide from σ = 0.05. Of the polynomials that are left out, the first order sees
    // most of P₅: j₅(π/2) = 8e-4 of its factor. A model of these points and terms in another language errs by 3.4e-5 at
    // σ = 0.05 and by less for the others.
    const double fine = efficiency_of(show(h, slm, with_effects({"crosstalk"}, 3, 32)), 8);
    EXPECT_NEAR(fine, expected, 6e-5) << sigma;
    // The default number of points is exact to 1 % of the light for this pattern, the worst case. If points are closer
    // than the edge is wide, the error falls exponentially: by more than 10 from 4 points to 8.
    const auto error = [&](int s) {
      return std::abs(efficiency_of(show(h, slm, with_effects({"crosstalk"}, 3, s)), 8) - expected);
    };
    if (sigma > 0.15) {
      EXPECT_LT(error(8), error(4) / 10) << sigma;
    }
    EXPECT_LT(error(0), 0.01) << sigma;
    EXPECT_LT(fine, last) << sigma;
    last = fine;
    EXPECT_NEAR(efficiency_of(show(h, slm, with_effects({})), 8), 4 / (pi * pi),
                efficiency_tolerance);  // effect off: unchanged
  }
}

TEST(Crosstalk, VanishesWithItsWidthAndLeavesEvenPhasesAlone) {
  Slm slm = make_panel(12, 10, 256, 0.9);
  const Hologram h = make_hologram(slm, Modulation::phase, [](int i) { return i * i * 37 % 256; });
  const Field sharp = show(h, slm, with_effects({}));
  double last = 1;
  for (const double sigma : {0.2, 0.05, 0.01}) {
    slm.effects.crosstalk = sigma;
    const Field blurred = show(h, slm, with_effects({"crosstalk"}, 3, 8));
    double difference = 0;
    for (size_t i = 0; i < sharp.samples.size(); ++i)
      difference = std::max(difference, double(std::abs(sharp.samples.values[i] - blurred.samples.values[i])));
    EXPECT_LT(difference, last);
    last = difference;
  }
  // The last of 8 points is 0.96·w/2 = 0.455 from the centre, 4.5 σ from the neighbour: it takes 3e-6 of the neighbour's phase,
  // and has a weight of 0.05. With rounding that is less than 4e-6 for phases up to 2π.
  EXPECT_LT(last, 4e-6);
  slm.effects.crosstalk = 0.4;
  const Hologram even = make_hologram(slm, Modulation::phase, [](int) { return 77; });
  const Field a = show(even, slm, with_effects({"crosstalk"})), b = show(even, slm, with_effects({}));
  for (size_t i = 0; i < a.samples.size(); ++i)
    EXPECT_LT(std::abs(a.samples.values[i] - b.samples.values[i]), 2e-6);  // rounding of 5 × 5 points
}

// Random phases, against the blurred light summed up in double on 48 points per pixel and axis. pixel_expansion.h has the
// errors: −43 dB of the light with one sample per pixel, −35 dB with three, −26 dB coarsely with one sample. The mean
// over each pixel lacks all that differs within it: −12 dB here, and −7 dB if it were only the light at the middle. Errors are larger at
// the edges of the orders, where half of these frequencies are.
TEST(Crosstalk, IsTheBlurredLightOfRandomPhases) {
  Slm slm = make_panel(15, 9, 256, 0.9);
  slm.effects.crosstalk = 0.2;
  const int nx = slm.grid.nx, ny = slm.grid.ny, points = 48;
  const double w = std::sqrt(0.9), sigma = 0.2;
  Array2D<float> drive(ny, nx);
  CounterRandom random(5, 0, 0);
  for (float& level : drive.values) level = float(256 * random.uniform());
  const auto kernel = [&](double x) {
    return 0.5 * (std::erf((x + 0.5) / std::sqrt(2.0) / sigma) - std::erf((x - 0.5) / std::sqrt(2.0) / sigma));
  };
  const auto place = [&](int k) { return k / points + w * ((k % points + 0.5) / points - 0.5); };  // [pixels]
  const auto line_of = [&](int count, const auto& value, int k) {  // of the blurred values
    double sum = 0;
    for (int d = -3; d <= 3; ++d)
      sum += kernel(place(k) - k / points - d) * value(((k / points + d) % count + count) % count);
    return sum;
  };
  Array2D<float> along_x(ny, nx * points), cycles(ny * points, nx * points);
  for (int j = 0; j < ny; ++j)
    for (int k = 0; k < nx * points; ++k)
      along_x(j, k) = float(line_of(
          nx, [&](int i) { return drive(j, i) / 256; }, k));
  for (int k = 0; k < nx * points; ++k)
    for (int m = 0; m < ny * points; ++m)
      cycles(m, k) = float(line_of(
          ny, [&](int j) { return along_x(j, k); }, m));
  const auto spectrum = [&](int a, int b) {  // û(a/nx, b/ny)
    std::complex<double> sum = 0;
    for (int m = 0; m < ny * points; ++m)
      for (int k = 0; k < nx * points; ++k)
        sum += std::polar(1.0, 2 * pi * (cycles(m, k) - a * place(k) / nx - b * place(m) / ny));
    return sum * w * w / double(points * points) / double(nx * ny);
  };
  // Frequencies in the middle, at the edge of order 0, and beyond it.
  const std::vector<std::pair<int, int>> frequencies{{1, -2}, {7, 4}, {-7, 1}, {3, -4}, {12, 2}, {-20, -11}};
  for (const int n : {1, 3})
    for (const PixelDetail detail : {PixelDetail::as_shown, PixelDetail::coarse, PixelDetail::mean}) {
      const ShowParams params{.subpixels = n};
      const PanelModel model(slm, params, Modulation::phase, 256, 0, {test_wavelength},
                             pixel_expansion(slm, params, detail));
      const Field field = model.leave(drive);
      double error = 0, light = 0;
      for (const auto& [a, b] : frequencies) {
        if (2 * std::abs(a) > n * nx || 2 * std::abs(b) > n * ny) continue;
        const std::complex<double> expected = spectrum(a, b);
        // Pixels are about their middles, samples about the middle of the panel.
        const std::complex<double> found =
            wave_in(field, a, -b) * std::polar(1.0, pi * (-a * (nx - 1.0) / nx - b * (ny - 1.0) / ny));
        error += std::norm(found - expected);
        light += std::norm(expected);
      }
      const double bound = detail == PixelDetail::mean ? -10 : detail == PixelDetail::coarse ? -20 : n == 1 ? -34 : -28;
      EXPECT_LT(10 * std::log10(error / light), bound) << n;
    }
}

// The same for pixels lit on a part w of their pitch, about their middles. The light is that of the blurred phase
// there, |½·Σ over two pixels of ∫ exp(iφ(x))·exp(−iπx) dx over w|², times a factor w² for the rows.
TEST(Crosstalk, IsLightOfTheLitPartOfAPixel) {
  Slm slm = make_panel(16, 4, 2, 0.5);
  const double w = std::sqrt(0.5);
  const Hologram h = make_hologram(slm, Modulation::phase, [](int i) { return i % 2; });
  for (const double sigma : {0.15, 0.3}) {
    slm.effects.crosstalk = sigma;
    const int points = 20000;
    std::complex<double> sum = 0;
    for (int k = 0; k < points; ++k) {
      const double x = 2 * (k + 0.5) / points, from_middle = std::abs(x - std::floor(x) - 0.5);
      if (from_middle > w / 2) continue;
      double wave = 0.5;
      for (int m = 1; m < 60; m += 2)  // exp(−(59π·0.15)²/2) underflows to 0
        wave += 2 / pi * std::sin(pi * m * x) / m * std::exp(-std::pow(pi * m * sigma, 2) / 2);
      sum += std::polar(1.0, pi * wave - pi * x);
    }
    // The sum's places miss the edges of the lit parts by up to half a step of 1/10000; points of a fully lit pixel would see
    // more of the blurred edges.
    EXPECT_NEAR(efficiency_of(show(h, slm, with_effects({"crosstalk"}, 3, 32)), 8),
                std::norm(sum / double(points)) * w * w, 5e-5)
        << sigma;
  }
}

// --- gaps ---------------------------------------------------------------------------------------

TEST(Gaps, ShineOnWhatPixelsLeave) {
  // A flat panel under gap light γ: order (0, 0) has F·t + (1 − F)·γ, order (1, 0) w·sinc(w)·w·(t − γ).
  Slm slm = make_panel(9, 9, 4, 0.8);  // odd: the orders' waves are 1 at the pixels' centres
  slm.effects.gap_amplitude = 0.6;
  slm.effects.gap_phase = 0.7;
  const std::complex<double> gap = std::polar(0.6, 0.7), t(0, 1);
  const double w = std::sqrt(0.8);
  for (const double sigma : {0.0, 0.2}) {
    slm.effects.crosstalk = sigma;
    const Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 1; });
    const Field f = show(h, slm, with_effects({"gaps", "crosstalk"}, 5));
    EXPECT_LT(std::abs(wave_in(f, 0, 0) - (0.8 * t + 0.2 * gap)), efficiency_tolerance);
    EXPECT_LT(std::abs(wave_in(f, 9, 0) - w * sinc(w) * w * (t - gap)), efficiency_tolerance);
    EXPECT_LT(std::abs(wave_in(f, 9, -18) - w * sinc(w) * w * sinc(2 * w) * (t - gap)), efficiency_tolerance);
  }
}

TEST(Gaps, OfFullAmplitudeKeepAllEnergy) {
  // |t| = 1 everywhere: the panel reflects all light that falls on it. 65 orders per axis hold all but the tails of the
  // edges between pixels and gaps, at most 2·2/(π²·65/2)·|t − γ|² = 1.3 % times |t − γ|² ≤ 4 per axis.
  Slm slm = make_panel(6, 6, 256, 0.7);
  slm.effects.gap_amplitude = 1;
  const Hologram h = make_hologram(slm, Modulation::phase, [](int i) { return 40 * i; });
  Heard heard;
  show(h, slm, with_effects({"gaps"}, 65), heard.observer());
  EXPECT_LT(heard.number("efficiency"), 1 + efficiency_tolerance);
  EXPECT_GT(heard.number("efficiency"), 1 - 2 * 4 * 0.013);
  EXPECT_EQ(std::get<std::string>(heard.facts.at("effects")), "gaps");
}

// --- static errors ------------------------------------------------------------------------------

TEST(StaticErrors, ZernikeTermsAreOrthonormalOverTheDisc) {
  // The mean of Z·Z' over the disc: 400 rings and 64 angles, with an error of (1/400)² per ring, are enough.
  const std::vector<std::pair<int, int>> terms{{0, 0}, {1, -1}, {1, 1}, {2, 0}, {2, 2}, {3, -1}, {4, 0}, {6, 0}};
  for (const auto& a : terms)
    for (const auto& b : terms) {
      double sum = 0;
      for (int r = 0; r < 400; ++r)
        for (int t = 0; t < 64; ++t) {
          const double rho = std::sqrt((r + 0.5) / 400), theta = 2 * pi * (t + 0.5) / 64;
          sum += zernike(a.first, a.second, rho, theta) * zernike(b.first, b.second, rho, theta);
        }
      EXPECT_NEAR(sum / (400 * 64), a == b ? 1 : 0, 2e-4) << a.first << " " << a.second << ", " << b.first;
    }
  EXPECT_DOUBLE_EQ(zernike(2, 0, 1, 0), std::sqrt(3.0));  // √3·(2ρ² − 1)
  EXPECT_NEAR(zernike(2, -2, 1, pi / 4), std::sqrt(6.0), 1e-15);
}

TEST(StaticErrors, TurnTheFieldPixelByPixel) {
  Slm slm = make_panel(9, 7, 4);
  slm.effects.aberration = {{1, 1, 0.5}};  // 2ρ·cos θ: a tilt by 2·0.5/R [rad/m], R the corner's distance
  auto map = std::make_shared<Array2D<float>>(7, 9);
  for (int j = 0; j < 7; ++j)
    for (int i = 0; i < 9; ++i) (*map)(j, i) = float(0.1 * j);
  slm.effects.phase_map = map;
  const Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 0; });
  // 21 samples per pixel: the middle one shows the pixel. The ringing of the edges is small for weak phase steps.
  const Field f = show(h, slm, with_effects({"aberration", "phase-map"}, 21));
  const double radius = std::hypot(slm.grid.width(), slm.grid.height()) / 2;
  for (int j = 0; j < 7; ++j)
    for (int i = 1; i < 8; ++i) {
      const double expected = slm.grid.x(i) / radius + 0.1 * j;
      const std::complex<double> u(f.samples(21 * j + 10, 21 * i + 10));
      EXPECT_NEAR(std::arg(u * std::polar(1.0, -expected)), 0, 0.03) << j << ", " << i;
    }
}

TEST(StaticErrors, DelayByALength) {
  // A phase given at the design wavelength is 1.5 times as large at two thirds of it.
  Slm slm = make_panel(5, 4, 4), larger = slm;
  Array2D<float> map(4, 5), map_there(4, 5);
  for (size_t i = 0; i < map.size(); ++i) {
    map.values[i] = float(i % 7) / 8;
    map_there.values[i] = 1.5F * map.values[i];
  }
  slm.effects.phase_map = std::make_shared<const Array2D<float>>(map);
  larger.effects.phase_map = std::make_shared<const Array2D<float>>(map_there);
  slm.effects.aberration = {{2, 0, 0.3}, {1, -1, 0.2}};
  larger.effects.aberration = {{2, 0, 1.5 * 0.3}, {1, -1, 1.5 * 0.2}};
  const Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 0; });
  ShowParams params = with_effects({"aberration", "phase-map"});
  params.wavelength = test_wavelength / 1.5;
  slm.design_wavelength = test_wavelength;
  larger.design_wavelength = params.wavelength;
  const Field a = show(h, slm, params), b = show(h, larger, params);
  for (size_t i = 0; i < a.samples.size(); ++i)
    EXPECT_LT(std::abs(a.samples.values[i] - b.samples.values[i]), 2e-6);  // rounding of two transforms
}

TEST(StaticErrors, MoveTheGapsToo) {
  // A mirror of even phase that is tilted by its phase map is still a tilted mirror, whatever part of it is gaps.
  Slm slm = make_panel(8, 8, 4, 0.6);
  auto map = std::make_shared<Array2D<float>>(8, 8);
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) (*map)(j, i) = float(0.2 * ((i * 5 + j * 3) % 7));
  slm.effects.phase_map = map;
  const Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 0; });
  Slm full = slm;
  full.fill_factor = 1;
  slm.effects.gap_amplitude = 1;
  const Field a = show(h, slm, with_effects({"all"})), b = show(h, full, with_effects({"all"}));
  for (size_t i = 0; i < a.samples.size(); ++i)
    EXPECT_LT(std::abs(a.samples.values[i] - b.samples.values[i]), 2e-6);  // rounding of two transforms
}

// --- light map ----------------------------------------------------------------------------------

TEST(LightMap, IsTheIrradianceOnEachPixelAndItsGaps) {
  // Of a mirror, with gaps of the same light as the pixels, every pixel sends √m of its own light: the samples of n = 1
  // are the pixels' own, and those of a panel without effects times √m.
  Slm slm = make_panel(6, 5, 4, 0.7);
  Array2D<float> map(5, 6);
  double sum = 0;
  for (size_t i = 0; i < map.size(); ++i) sum += map.values[i] = float(i % 7) / 4;
  slm.effects.light_map = std::make_shared<const Array2D<float>>(map);
  slm.effects.gap_amplitude = 1;
  const Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 0; });
  Slm full = slm;
  full.fill_factor = 1;
  Heard heard;
  const Field a = show(h, slm, with_effects({"all"}, 1), heard.observer()), b = show(h, full, with_effects({"all"}, 1));
  const Field off = show(h, slm, with_effects({"gaps"}, 1)), even = show(h, full, with_effects({}, 1));
  for (size_t i = 0; i < a.samples.size(); ++i) {
    EXPECT_LT(std::abs(a.samples.values[i] - b.samples.values[i]), 2e-6);  // rounding of two transforms
    EXPECT_LT(std::abs(off.samples.values[i] - even.samples.values[i]), 2e-6);
  }
  // The light of all samples together is that of the map, roll-off aside; the panel with F = 1 and n = 1 keeps the mean.
  EXPECT_NEAR(heard.number("power_in"), sum / 30 * slm.grid.width() * slm.grid.height(),
              1e-6 * heard.number("power_in"));
  // A sample in the middle of a pixel, of 21 per side, shows its √m; the ringing of the edges is 1/21π of a step.
  const Field fine = show(h, full, with_effects({"light-map"}, 21));
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 6; ++i)
      EXPECT_NEAR(std::abs(fine.samples(21 * j + 10, 21 * i + 10)), std::sqrt(map(j, i)), 0.03) << j << ", " << i;
}

// --- dead pixels --------------------------------------------------------------------------------

TEST(DeadPixels, ShowTheirLevelWhateverTheyAreSent) {
  Slm slm = make_panel(6, 5, 8);
  slm.effects.dead_pixels = {{4, 3, 5}, {0, 0, 2}};
  const Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 1; });
  Hologram stuck = h;
  stuck.level(3, 4) = 5;
  stuck.level(0, 0) = 2;
  EXPECT_EQ(show(h, slm, with_effects({"dead-pixels"})).samples.values,
            show(stuck, slm, with_effects({})).samples.values);
}

TEST(DeadPixels, ShowTheirLevelOfThePanelInHologramsOfFewerLevels) {
  // Level 5 of 8: 5/7 of the amplitude, or 5/8 of a turn, whatever the levels of the hologram.
  Slm slm = make_panel(1, 1, 8);
  slm.effects.dead_pixels = {{0, 0, 5}};
  for (const int levels : {2, 4, 8}) {
    const auto shown = [&](Modulation modulation) {
      Hologram h = make_hologram(slm, modulation, [](int) { return 0; });
      h.levels = levels;
      return std::complex<double>(show(h, slm, with_effects({"dead-pixels"}, 1)).samples(0, 0));
    };
    EXPECT_LT(std::abs(shown(Modulation::amplitude) - 5.0 / 7), efficiency_tolerance) << levels;
    EXPECT_LT(std::abs(shown(Modulation::phase) - std::polar(1.0, 2 * pi * 5 / 8)), efficiency_tolerance) << levels;
  }
}

TEST(DeadPixels, ShowEachLevelAsOftenAsAnyOther) {
  const int levels = 4;
  Slm slm = make_panel(256, 256, levels);
  slm.effects.dead_fraction = 1;
  std::vector<double> counts(levels);
  for (const StuckPixel& pixel : stuck_pixels(slm)) ++counts[size_t(pixel.level)];
  const double pixels = 256.0 * 256, part = 1.0 / levels;
  for (const double count : counts)
    EXPECT_NEAR(count, part * pixels, 4 * std::sqrt(pixels * part * (1 - part)));  // 4 σ
}

TEST(DeadPixels, TakeTheirFractionFromTheImageAndScatterIt) {
  // A fraction f at random levels: order 0 has the amplitude 1 − k/N, k of N pixels dead, plus k random phasors. Their
  // mean over levels is 0 and their rms √k/N. k is binomial.
  const int nx = 256, ny = 256;
  const double f = 0.02, pixels = double(nx) * ny;
  Slm slm = make_panel(nx, ny, 256);
  slm.effects.dead_fraction = f;
  const double dead = double(stuck_pixels(slm).size());
  EXPECT_NEAR(dead, f * pixels, 4 * std::sqrt(pixels * f * (1 - f)));  // 4 σ
  const Hologram h = make_hologram(slm, Modulation::phase, [](int) { return 0; });
  const Field field = show(h, slm, with_effects({"dead-pixels"}, 1));
  EXPECT_LT(std::abs(wave_in(field, 0, 0) - (1 - dead / pixels)), 4 * std::sqrt(dead) / pixels);
  // Another seed gives other pixels, the same seed the same ones.
  Slm other = slm;
  other.effects.dead_seed = 2;
  EXPECT_EQ(show(h, slm, with_effects({"dead-pixels"}, 1)).samples.values, field.samples.values);
  EXPECT_NE(show(h, other, with_effects({"dead-pixels"}, 1)).samples.values, field.samples.values);
}

// --- flicker ------------------------------------------------------------------------------------

TEST(Flicker, AveragesARampOverItsDepths) {
  // A ramp that ripples by ±q: its mean η₁ is that of sinc²(e) over e = q·sin θ. 16 even steps of θ integrate a smooth
  // periodic function to rounding; 64 pixels per period cost sinc²(1/64) and π²/3·64² = 8e-4 of the ripple's loss.
  const int steps = 64;
  Slm slm = make_panel(steps, 1, steps);
  slm.effects.flicker = 0.2;
  const Hologram h = make_hologram(slm, Modulation::phase, [](int i) { return i; });
  const ShowParams params = with_effects({"flicker"});
  double mean = 0, expected = 0;
  const std::vector<IlluminationState> all =
      illumination_states(with_effects(slm, params.effects), params, test_wavelength);
  EXPECT_EQ(all.size(), 16u);
  for (const IlluminationState& m : all) mean += m.weight * efficiency_of(show(h, slm, params, m), 1);
  const int points = 1000;
  for (int k = 0; k < points; ++k) {
    const double e = 0.2 * std::sin(2 * pi * (k + 0.5) / points);
    expected += std::pow(sinc(e), 2) / points;
  }
  EXPECT_LT(expected, 0.94);  // the loss is large enough to measure: π²q²/6 = 6.6 %
  EXPECT_NEAR(mean, expected * std::pow(sinc(1.0 / steps), 2), 1e-4);
  // The mean state has no ripple.
  EXPECT_NEAR(efficiency_of(show(h, slm, params), 1), std::pow(sinc(1.0 / steps), 2), efficiency_tolerance);
}

// --- complex modulation -------------------------------------------------------------------------

TEST(ComplexModulation, ShowsPhaseAndAmplitudeIndependently) {
  Slm slm = make_panel(8, 6, 256, 0.9);
  slm.modulation = Modulation::complex;
  Hologram h = make_hologram(slm, Modulation::complex, [](int i) { return i * 31 % 256; });
  h.modulus_level = Array2D<uint16_t>(6, 8);
  for (size_t i = 0; i < h.modulus_level.size(); ++i) h.modulus_level.values[i] = uint16_t(i * 53 % 256);
  const Field f = show(h, slm, with_effects({}, 1));
  // Expected: the sum of one hologram per pixel, because the field is linear in a·exp(iφ).
  Field sum(f.grid, f.wavelength);
  Hologram one = h;
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 8; ++i) {
      std::fill(one.modulus_level.values.begin(), one.modulus_level.values.end(), uint16_t(0));
      one.modulus_level(j, i) = 255;
      const Field pixel = show(one, slm, with_effects({}, 1));
      for (size_t k = 0; k < sum.samples.size(); ++k)
        sum.samples.values[k] += pixel.samples.values[k] * (float(h.modulus_level(j, i)) / 255.0F);
    }
  for (size_t k = 0; k < sum.samples.size(); ++k)
    EXPECT_LT(std::abs(sum.samples.values[k] - f.samples.values[k]), 1e-5);  // 48 terms of rounding 1e-7
  h.modulus_level = {};
  EXPECT_EQ(error_of([&] { show(h, slm, with_effects({}, 1)); }),
            "expected levels of amplitude beside those of phase in a complex hologram of 8 × 6 pixels, got 0 × 0");
}

}  // namespace
}  // namespace holotrace
