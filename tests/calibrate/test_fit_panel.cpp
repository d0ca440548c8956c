#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "calibrate/photographs.h"
#include "holotrace/calibrate/fit_panel.h"
#include "holotrace/calibrate/least_squares.h"
#include "holotrace/calibrate/patterns.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

constexpr int side = 128;

CalibrationPlan small_plan() {
  return {0.05, make_test_patterns(assumed_panel(side, side), bench_wavelength, 0.05,
                                   {.measured_levels = 9, .level_patterns = 8, .focus_patterns = 1})};
}
// Few patterns, for tests of bad input.
CalibrationPlan short_plan() {
  return {0.05, make_test_patterns(assumed_panel(side, side), bench_wavelength, 0.05,
                                   {.measured_levels = 5, .level_patterns = 3, .focus_patterns = 1})};
}
const CalibrateParams short_fit{.aberration_order = 2, .light_order = 1, .amplitude_order = 0, .samples = 3000};
const CalibrateParams small_fit{.aberration_order = 3, .light_order = 2, .amplitude_order = 2, .samples = 8000};

const std::vector<Image>& good_photographs() {
  static const std::vector<Image> photos = photographs_of(short_plan(), hidden_panel(side, side), {});
  return photos;
}

// The rms over the panel of a difference of wavefronts, without piston and tilt.
double wavefront_rms(const std::vector<ZernikeTerm>& terms) {
  const Grid grid{side, side, 8e-6};
  Eigen::MatrixX3d plane(side * side, 3);
  Eigen::VectorXd phase = Eigen::VectorXd::Zero(side * side);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) plane.row(j * side + i) << 1, i, j;
  for (const ZernikeTerm& term : terms) {
    const Array2D<float> values = zernike_on(grid, term);
    for (int i = 0; i < side * side; ++i) phase[i] += term.rms * values.values[size_t(i)];
  }
  const Eigen::Vector3d best = (plane.transpose() * plane).ldlt().solve(plane.transpose() * phase);
  return (phase - plane * best).norm() / side;
}

TEST(FitPanel, RecoversAHiddenPanel) {
  const Slm hidden = hidden_panel(side, side);
  const CalibrationPlan plan = small_plan();
  const PanelFit fit = fit_panel(plan, photographs_of(plan, hidden, {}), small_fit);
  // The limits of issue 13: 0.02 rad rms for the curve, 0.05 rad rms for the wavefront.
  double square = 0;
  for (int level = 0; level < 256; ++level) {
    const double fitted = fit.slm.effects.calibration[size_t(level)].phase;
    square += std::pow(fitted - (hidden_phase(level) - hidden_phase(0)), 2);
  }
  EXPECT_LT(std::sqrt(square / 256), 0.02);
  std::vector<ZernikeTerm> difference = fit.slm.effects.aberration;
  ASSERT_EQ(difference.size(), 7u);
  for (ZernikeTerm term : hidden.effects.aberration) {
    term.rms = -term.rms;
    difference.push_back(term);
  }
  EXPECT_GT(wavefront_rms(hidden.effects.aberration), 0.3);  // there is something to find
  EXPECT_LT(wavefront_rms(difference), 0.05);
  EXPECT_NEAR(fit.crosstalk.value, 0.3, 0.02);
  // γ·(1 − F)/F of the hidden panel; the assumed panel has another fill factor.
  EXPECT_NEAR(fit.gap_light.value, 0.6 * 0.1 / 0.9, 0.015);
  EXPECT_NEAR(fit.gap_phase.value, 0.7, 0.25);
  double mean = 0, light_error = 0;
  for (const float value : hidden.effects.light_map->values) mean += value / (side * side);
  for (size_t i = 0; i < hidden.effects.light_map->size(); ++i)
    light_error += std::pow(fit.slm.effects.light_map->values[i] - hidden.effects.light_map->values[i] / mean, 2);
  EXPECT_LT(std::sqrt(light_error / (side * side)), 0.03);
  const TestCamera camera;
  EXPECT_NEAR(fit.camera_scale, 8e-6 / camera.pixel, 1e-3);
  EXPECT_NEAR(fit.camera_rotation, camera.rotation, 1e-3);
  for (const PhotographFit& photograph : fit.photographs) EXPECT_GT(photograph.correlation, 0.97) << photograph.name;
}

// A panel that the fit can explain whole, without noise, and a camera that stands upright: what is left is the interpolation of the
// simulation's samples. It moved the crosstalk by 0.0002 pixels and the variance of the blur by 0.007 pixels².
TEST(FitPanel, FindsCrosstalkAndTheBlurOfTheLens) {
  Slm hidden = assumed_panel(side, side);
  hidden.effects.crosstalk = 0.3;
  hidden.effects.aberration = {{2, 2, -0.4}};
  TestCamera camera;
  camera.electrons = camera.rotation = camera.shift_x = camera.shift_y = 0;
  const PanelFit sharp = fit_panel(short_plan(), photographs_of(short_plan(), hidden, camera), short_fit);
  camera.blur = 0.15;
  const PanelFit soft = fit_panel(short_plan(), photographs_of(short_plan(), hidden, camera), short_fit);
  EXPECT_NEAR(sharp.crosstalk.value, 0.3, 0.003);
  EXPECT_NEAR(soft.crosstalk.value, 0.3, 0.003);
  EXPECT_NEAR(soft.camera_blur.value - sharp.camera_blur.value, camera.blur, 0.015);
}

// The panel of docs/how_to/calibrate_a_panel.md in small: a straight curve to 400° and astigmatism. With samples of the simulation on
// the panel's own pixels the crosstalk was a tenth too small.
TEST(FitPanel, FindsThePanelOfItsPage) {
  constexpr double turn = 400 * pi / 180;
  const CalibrationPlan plan{0.05,
                             make_test_patterns(assumed_panel(side, side), bench_wavelength, 0.05,
                                                {.measured_levels = 9, .level_patterns = 6, .focus_patterns = 1})};
  Slm hidden = assumed_panel(side, side);
  hidden.effects.crosstalk = 0.3;
  hidden.effects.aberration = {{2, 2, 0.4}};
  for (int level = 0; level < 256; ++level) hidden.effects.calibration.push_back({turn * level / 256, 1});
  TestCamera camera{.rotation = 0, .shift_x = 0, .shift_y = 0, .nx = 171, .ny = 171, .electrons = 0};
  const PanelFit fit = fit_panel(plan, photographs_of(plan, hidden, camera), short_fit);
  EXPECT_NEAR(fit.crosstalk.value, 0.3, 0.006);
  EXPECT_NEAR(fit.slm.effects.calibration.back().phase, turn * 255 / 256, 0.005 * turn);
}

TEST(FitPanel, StatesItsErrors) {
  // Photographs by the bench itself with noise: the fit differs from the truth by its standard errors. The mean square of
  // 15 nearly independent deviations is 1 ± √(2/15); within a factor of 3 is 5 σ above, and more than 2 σ below.
  CalibrationPlan plan = small_plan();
  plan.patterns.erase(plan.patterns.begin() + 6, plan.patterns.end() - 1);
  CalibrateParams params = small_fit;
  params.light_order = params.amplitude_order = 0;
  const CalibrationBench bench(make_basis(plan.patterns, params), plan.distance);
  Unknowns truth = first_guess(bench.basis(), assumed_panel(side, side), plan.patterns.size());
  truth.aberration = {0.1, 0.4, -0.3, 0.1, 0.2, -0.1, 0.05};
  for (size_t k = 0; k < 9; ++k) truth.phases[k] = hidden_phase(bench.basis().levels[k]) - hidden_phase(0);
  truth.crosstalk = 0.25;
  truth.gap = 0.06;
  std::vector<Image> photographs;
  CameraParams noise;
  noise.electrons = 3000;
  for (const TestPattern& pattern : plan.patterns) {
    const Channel irradiance = bench.irradiance(pattern.hologram, truth);
    Image image(irradiance.ny, irradiance.nx, 1);
    const float top = *std::max_element(irradiance.values.begin(), irradiance.values.end());
    // A camera whose pixels are the panel's: the mean over a pixel, from its neighbours (see PixelMeans' test).
    for (int j = 1; j + 1 < image.ny; ++j)
      for (int i = 1; i + 1 < image.nx; ++i) {
        const float around = irradiance(j - 1, i) + irradiance(j + 1, i) + irradiance(j, i - 1) + irradiance(j, i + 1);
        image(j, i) = (irradiance(j, i) + (around - 4 * irradiance(j, i)) / 24) / (1.05F * top);
      }
    photographs.push_back(add_sensor_noise(image, 1, noise, uint32_t(photographs.size())));
  }
  const PanelFit fit = fit_panel(plan, photographs, params);
  double sum = 0;
  int count = 0;
  const auto add = [&](double value, double error, double expected) {
    ASSERT_GT(error, 0);
    sum += std::pow((value - expected) / error, 2);
    ++count;
  };
  for (size_t k = 1; k < 9; ++k) add(fit.levels[k].phase.value, fit.levels[k].phase.error, truth.phases[k]);
  for (size_t k = 0; k < 7; ++k) add(fit.aberration[k].rms.value, fit.aberration[k].rms.error, truth.aberration[k]);
  EXPECT_EQ(count, 15);
  EXPECT_LT(sum / count, 3);
  EXPECT_GT(sum / count, 1 / 3.0);
}

std::string refusal(const std::vector<Image>& photographs, const CalibrationPlan& plan = short_plan(),
                    CalibrateParams params = short_fit) {
  return error_of([&] { fit_panel(plan, photographs, params); });
}

TEST(FitPanel, RefusesPhotographsThatCannotBeUsed) {
  std::vector<Image> photos = good_photographs();
  photos.pop_back();
  EXPECT_EQ(refusal(photos), "expected a photograph for each of 5 patterns, got 4");

  photos = good_photographs();
  photos[2] = Image(100, 90, 1);
  EXPECT_EQ(
      refusal(photos),
      "03_levels: expected a photograph of 230 × 220 pixels, as that of 01_spots, got 90 × 100; take all with one "
      "camera that does not move, and do not crop them");

  photos = good_photographs();
  std::fill(photos[3].values.begin(), photos[3].values.end(), 0.0F);
  EXPECT_EQ(refusal(photos), "04_levels: expected a photograph with light, got a black one; check the exposure");

  photos = good_photographs();
  for (float& value : photos[1].values) value = std::min(0.05F, value);
  const std::string saturated = refusal(photos);
  EXPECT_EQ(saturated.substr(0, 68), "02_levels: expected a photograph whose brightest pixels differ, got ")
      << saturated;
  EXPECT_NE(saturated.find("it is saturated: expose for a shorter time"), std::string::npos) << saturated;

  // The photograph of another pattern.
  photos = good_photographs();
  photos[2] = photos[3];
  const std::string swapped = refusal(photos);
  EXPECT_EQ(swapped.substr(0, 71), "03_levels: expected a photograph of this pattern, got one whose correla")
      << swapped;

  // Mirror images; with `mirrored` the search goes on, up to the iterations that it is given.
  photos = good_photographs();
  for (Image& photo : photos)
    for (int j = 0; j < photo.ny; ++j) std::reverse(&photo(j, 0), &photo(j, 0) + photo.nx);
  const std::string lost = refusal(photos);
  EXPECT_EQ(
      lost,
      "expected photographs that show the spots of their patterns at 50 mm from the panel, got some in which these are not "
      "found; check the distance, that there is no lens before the sensor, and whether the photographs are mirror images "
      "(mirrored)");
  CalibrateParams params = short_fit;
  params.is_mirrored = true;
  params.iterations = 1;
  EXPECT_EQ(refusal(photos, short_plan(), params).substr(0, 34), "expected the fit to converge, but ");
}

TEST(FitPanel, RefusesPlansThatDetermineTooLittle) {
  CalibrationPlan plan = short_plan();
  plan.patterns.resize(1);
  const std::vector<Image> one(good_photographs().begin(), good_photographs().begin() + 1);
  EXPECT_EQ(refusal(one, plan),
            "expected patterns with at least 3 levels, got 2; write patterns with more measured levels");
  plan = short_plan();
  plan.patterns[0].kind = PatternKind::levels;
  EXPECT_EQ(
      refusal(good_photographs(), plan),
      "expected a pattern of the kind \"spots\", which shows where the camera is, got none; write the patterns again");
  plan = short_plan();
  plan.patterns[1].hologram.wavelength = 532e-9;
  EXPECT_EQ(refusal(good_photographs(), plan),
            "02_levels: expected a phase pattern for the same panel and wavelength as 01_spots, got another; write the "
            "patterns again");
  plan = short_plan();
  plan.patterns[1].hologram.slm.reset();
  EXPECT_EQ(refusal(good_photographs(), plan),
            "02_levels: expected a pattern with the panel it was made for, got none; write the patterns again");
  CalibrateParams params = short_fit;
  params.iterations = 1;
  EXPECT_EQ(
      refusal(good_photographs(), short_plan(), params),
      "expected the fit to converge, but after 1 iterations the misfit still falls; give more iterations, or lower "
      "the orders of the aberration and the light");
}

}  // namespace
}  // namespace holotrace
