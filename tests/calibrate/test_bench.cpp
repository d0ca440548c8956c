#include <gtest/gtest.h>

#include "calibrate/photographs.h"
#include "holotrace/calibrate/bench.h"
#include "holotrace/calibrate/measured_panel.h"
#include "holotrace/calibrate/patterns.h"
#include "holotrace/calibrate/photo.h"
#include "holotrace/slm/panel/panel_model.h"

namespace holotrace {
namespace {

constexpr double distance = 0.05;

struct Case {
  std::vector<TestPattern> patterns = make_test_patterns(assumed_panel(96, 80), bench_wavelength, distance,
                                                         {.measured_levels = 5, .level_patterns = 2});
  CalibrateParams params{.aberration_order = 3, .light_order = 2, .amplitude_order = 2};
  CalibrationBench bench{make_basis(patterns, params), distance};
  Unknowns unknowns = first_guess(bench.basis(), assumed_panel(96, 80), patterns.size());

  Case() {
    unknowns.light = {0.2, -0.1, -0.3, 0.05, -0.2};
    for (size_t k = 0; k < unknowns.aberration.size(); ++k) unknowns.aberration[k] = 0.1 * double(k) - 0.25;
    unknowns.phases = {0, 1.3, 3.2, 4.9, 6.8};
    unknowns.amplitude = {0.02, -0.03};
    unknowns.crosstalk = 0.3;
    unknowns.blur = 0.1;
    unknowns.gap = std::polar(0.05, 0.6);
  }
};

double rms(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += double(v) * v;
  return std::sqrt(sum / double(values.size()));
}

TEST(CalibrationBench, ShowsWhatThePanelModelShows) {
  // The same panel, written as an Slm. The bench multiplies wavefront and light after the aperture: over a pixel they
  // change by a few 1e-3. The assumed fill factor is 0.93; γ = 0.05·F/(1 − F) = 0.664.
  Case c;
  c.unknowns.blur = 0;
  Slm slm = assumed_panel(96, 80);
  slm.design_wavelength = bench_wavelength;
  slm.effects.crosstalk = 0.3;
  slm.effects.gap_amplitude = 0.05 * 0.93 / 0.07;
  slm.effects.gap_phase = 0.6;
  slm.effects.calibration.assign(256, {});
  for (size_t k = 0; k < 5; ++k) {
    const int level = c.bench.basis().levels[k], next = k < 4 ? c.bench.basis().levels[k + 1] : 256;
    for (int l = level; l < next; ++l)
      slm.effects.calibration[size_t(l)] = {c.unknowns.phases[k], amplitude_of(c.bench.basis(), c.unknowns, level)};
  }
  const double most = 1.0 / 1.1;  // amplitudes of a calibration are at most 1
  for (CalibrationPoint& point : slm.effects.calibration) point.amplitude *= most;
  slm.effects.gap_amplitude *= most;
  Array2D<float> light(80, 96);
  for (size_t k = 0; k < 5; ++k) {
    const Array2D<float> term = light_term_on(slm.grid, c.bench.basis().light[k]);
    for (size_t i = 0; i < light.size(); ++i) light.values[i] += float(c.unknowns.light[k]) * term.values[i];
  }
  for (float& value : light.values) value = std::exp(value);
  slm.effects.light_map = std::make_shared<const Array2D<float>>(light);
  for (size_t k = 0; k < c.unknowns.aberration.size(); ++k) {
    ZernikeTerm term = c.bench.basis().aberration[k];
    term.rms = c.unknowns.aberration[k];
    slm.effects.aberration.push_back(term);
  }
  for (const TestPattern& pattern : c.patterns) {
    ShowParams params;
    params.effects = {"all"};
    const Field there = propagate(show(pattern.hologram, slm, params), distance);
    const Channel irradiance = c.bench.irradiance(pattern.hologram, c.unknowns);
    ASSERT_EQ(irradiance.values.size(), there.samples.size());
    std::vector<float> difference;
    for (size_t i = 0; i < irradiance.values.size(); ++i)
      difference.push_back(std::norm(there.samples.values[i]) / float(most * most) - irradiance.values[i]);
    EXPECT_LT(rms(difference), 0.01 * rms(irradiance.values)) << pattern.name;
  }
}

TEST(CalibrationBench, BlursByItsVariance) {
  // A blur of the variance v per axis changes the mean under a smooth weight w by v/2·∇²w. With w = cos⁴(x/a)·cos⁴(y/a)
  // up to its first zeros, a of 20 samples, differences of samples for ∇² are off by some (1/a)², 0.3 %.
  Case c;
  const double v = c.unknowns.blur;
  ASSERT_EQ(v, 0.1);
  const Hologram& pattern = c.patterns[1].hologram;
  const Channel blurred = c.bench.irradiance(pattern, c.unknowns);
  c.unknowns.blur = 0;
  const Channel sharp = c.bench.irradiance(pattern, c.unknowns);
  constexpr double a = 20;
  double found = 0, expected = 0;
  for (int j = 0; j < sharp.ny; ++j)
    for (int i = 0; i < sharp.nx; ++i) {
      const double x = (i - sharp.u_centre()) / a, y = (j - sharp.v_centre()) / a;
      if (std::abs(x) >= pi / 2 || std::abs(y) >= pi / 2) continue;
      const double cx = std::pow(std::cos(x), 2), cy = std::pow(std::cos(y), 2), wx = cx * cx, wy = cy * cy;
      // (cos⁴x)″ = 12·cos²x − 16·cos⁴x
      const double laplacian = ((12 * cx - 16 * wx) * wy + (12 * cy - 16 * wy) * wx) / (a * a);
      found += wx * wy * double(blurred(j, i) - sharp(j, i));
      expected += v / 2 * laplacian * double(sharp(j, i));
    }
  EXPECT_NEAR(found, expected, 0.02 * std::abs(expected));
}

// Whatever the amplitude of level 0, to which those of the bench are relative.
TEST(MeasuredPanel, HasAmplitudesRelativeToTheLargest) {
  Case c;
  c.unknowns.amplitude = {0.3, -0.1};
  const Slm slm = measured_panel(c.bench, assumed_panel(96, 80), c.unknowns, {}).slm;
  const std::vector<CalibrationPoint>& points = slm.effects.calibration;
  ASSERT_EQ(points.size(), 256u);
  double largest = 0;
  for (int level = 0; level < 256; ++level)
    largest = std::max(largest, amplitude_of(c.bench.basis(), c.unknowns, level));
  ASSERT_GT(largest, 1.1);
  for (int level = 0; level < 256; ++level)
    EXPECT_DOUBLE_EQ(points[size_t(level)].amplitude, amplitude_of(c.bench.basis(), c.unknowns, level) / largest);
  EXPECT_NO_THROW(check_slm(slm));
}

TEST(CalibrationBench, SlopesAreThoseOfFiniteDifferences) {
  const Case c;
  std::vector<Unknown> of;
  for (size_t k = 0; k < 5; ++k) of.push_back({UnknownKind::light, k});
  for (size_t k = 0; k < c.unknowns.aberration.size(); ++k) of.push_back({UnknownKind::aberration, k});
  for (size_t k = 1; k < 5; ++k) of.push_back({UnknownKind::phase, k});
  of.push_back({UnknownKind::blur, 0});
  of.push_back({UnknownKind::amplitude, 0});
  of.push_back({UnknownKind::amplitude, 1});
  of.push_back({UnknownKind::crosstalk, 0});
  of.push_back({UnknownKind::gap, 0});
  of.push_back({UnknownKind::gap, 1});
  const Hologram& pattern = c.patterns[1].hologram;
  const auto response = c.bench.respond(pattern, c.unknowns, of);
  EXPECT_EQ(response.irradiance.values, c.bench.irradiance(pattern, c.unknowns).values);
  for (size_t n = 0; n < of.size(); ++n) {
    // Central differences: an error of h²/6 of the third derivative, about 1e-4; forward ones in the bench, of a step of
    // 0.003 to 0.01, are off by half a step of the second, up to 1 %.
    Unknowns up = c.unknowns, down = c.unknowns;
    const double h = 0.02;
    value_of(up, of[n]) += h;
    value_of(down, of[n]) -= h;
    const Channel a = c.bench.irradiance(pattern, up), b = c.bench.irradiance(pattern, down);
    std::vector<float> expected(a.values.size()), difference(a.values.size());
    for (size_t i = 0; i < a.values.size(); ++i) {
      expected[i] = (a.values[i] - b.values[i]) / float(2 * h);
      difference[i] = expected[i] - (response.slopes[n].values.empty() ? 0 : response.slopes[n].values[i]);
    }
    EXPECT_LT(rms(difference), 0.03 * rms(expected) + 1e-6) << int(of[n].kind) << ", " << of[n].index;
  }
}

TEST(PixelMeans, OfAParabolaOverATurnedPixelAreExact) {
  // The mean over a square of side s, at any angle, of q(x, y) = x² + 2xy − y² + 3x: its value at the middle, plus s²/24
  // times its Laplacian, which is 0 here; of x² + y² it is the value plus s²/6. Cubic convolution reproduces parabolas.
  for (const double size : {0.7, 1.4, 3.2}) {
    const Similarity camera{size * std::cos(0.4), size * std::sin(0.4), 1.3, -2.1};
    Channel harmonic(90, 100), square(90, 100);
    for (int j = 0; j < 90; ++j)
      for (int i = 0; i < 100; ++i) {
        const double x = i - harmonic.u_centre(), y = j - harmonic.v_centre();
        harmonic(j, i) = float(x * x + 2 * x * y - y * y + 3 * x);
        square(j, i) = float(x * x + y * y);
      }
    PhotoPixels pixels;
    pixels.u = {0, 3, -7.5F, 1000};
    pixels.v = {0, -5, 4.5F, 0};
    pixels.value = {1, 1, 1, 1};
    const PixelMeans means(pixels, camera, harmonic);
    const Eigen::VectorXd of_harmonic = means.of(harmonic), of_square = means.of(square);
    const auto slopes = means.slopes_of(harmonic);
    for (int n = 0; n < 3; ++n) {
      const double u = pixels.u[size_t(n)], v = pixels.v[size_t(n)];
      const auto [x, y] = camera(u, v);
      EXPECT_NEAR(of_harmonic[n], x * x + 2 * x * y - y * y + 3 * x, 2e-3) << size;  // floats of some 1e3
      EXPECT_NEAR(of_square[n], x * x + y * y + size * size / 6, 2e-3) << size;
      // By the shift: the mean of the slope, which is linear.
      EXPECT_NEAR(slopes(n, 2), 2 * x + 2 * y + 3, 2e-3) << size;
      EXPECT_NEAR(slopes(n, 3), 2 * x - 2 * y, 2e-3) << size;
    }
    EXPECT_TRUE(std::isnan(of_harmonic[3]));
    EXPECT_EQ(slopes.row(3).norm(), 0);
  }
}

TEST(GapFigures, SendTheLightToOrder0ByTheAssumedFillOrASmallerOne) {
  // γ·(1 − F)/F is the light.
  const GapFigures weak = gap_figures(0.9, std::polar(0.05, 0.3));
  EXPECT_DOUBLE_EQ(weak.fill_factor, 0.9);
  EXPECT_NEAR(weak.amplitude * 0.1 / 0.9, 0.05, 1e-12);
  EXPECT_NEAR(weak.phase, 0.3, 1e-12);
  for (const double assumed : {0.9, 1.0}) {
    const GapFigures strong = gap_figures(assumed, 0.25);
    EXPECT_DOUBLE_EQ(strong.fill_factor, 0.8);
    EXPECT_DOUBLE_EQ(strong.amplitude, 1);
  }
  EXPECT_EQ(gap_figures(0.9, 0).amplitude, 0);
}

}  // namespace
}  // namespace holotrace
