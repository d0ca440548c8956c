#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/encode/iterate/gradient_descent.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "support/targets.h"

namespace holotrace {
namespace {

// f(ℓ) of gradient_descent.h for one frame without rounding, and its gradient if `slope` is given.
double loss(const std::vector<TargetPlane>& targets, const Slm& slm, const Hologram& hologram,
            const Array2D<float>& drive, Array2D<float>* slope) {
  double sum = 0;
  for (const TargetPlane& target : targets) {  // each with its own wavelength
    const DrivenPanel panel(slm, hologram, target.wavelength);
    const TargetPropagation propagation(slm, target.wavelength, target.z,
                                        {.aperture = panel.aperture(), .samples = PixelSamples::four});
    Field u(slm.grid, target.wavelength);
    panel.leave(drive, u);
    std::vector<Field> shown = propagation.to_plane(u);
    Array2D<float> light = power_of(shown, slm.grid);
    const ModulusSums sums = fit_sums(target, light);
    const double s = sums.cross / sums.square;
    sum += s * s * leave_residual(target, 1 / s, light);
    multiply(light, shown);
    if (slope) panel.add_slope(drive, u, propagation.to_panel(shown), -2 * s * s, *slope);
  }
  return sum;
}

Hologram blank_hologram(const Slm& slm) {
  return make_hologram(slm, Modulation::phase, [](int) { return 0; });
}

TEST(GradientDescent, GradientIsThatOfFiniteDifferences) {
  // Central differences along the gradient: the error is of third order in the step; 1 % covers it and the floats.
  const EncodeParams params{.target_distances = {0.004}, .target_columns = 40, .target_rows = 24};
  for (const bool has_effects : {false, true})
    for (const int colours : {1, 2}) {
      Slm slm = make_panel(64, 40, 256, 0.9);
      if (has_effects) {
        slm.effects.crosstalk = 0.25;
        slm.effects.gap_amplitude = 0.5;
        slm.effects.aberration = {{2, 0, 0.4}};
      }
      std::vector<TargetPlane> targets = picture_targets(slm, params);
      if (colours == 2) targets.push_back(picture_targets(slm, params, 633e-9).front());
      Hologram hologram;
      hologram.grid = slm.grid;
      hologram.levels = 256;
      hologram.wavelength = test_wavelength;
      Array2D<float> drive(40, 64), slope(40, 64);
      CounterRandom random(5, 0, 0);
      for (float& level : drive.values) level = float(20.3 + 200 * random.uniform());
      loss(targets, slm, hologram, drive, &slope);
      double square = 0, most = 0;
      for (const float d : slope.values) {
        square += double(d) * d;
        most = std::max(most, std::abs(double(d)));
      }
      const double h = 2 / most;  // the largest change is 2 levels, 0.05 rad
      const auto at = [&](double step) {
        Array2D<float> moved = drive;
        for (size_t i = 0; i < moved.size(); ++i) moved.values[i] += float(step * double(slope.values[i]));
        return loss(targets, slm, hologram, moved, nullptr);
      };
      EXPECT_NEAR((at(h) - at(-h)) / (2 * h) / square, 1, 0.01) << has_effects << " " << colours;
    }
}

// Kingma and Ba (2015), algorithm 1, in double, with its two corrections as written there:
// m̂ = m/(1 − β₁ᵗ), v̂ = v/(1 − β₂ᵗ), x ← x − α·m̂/√v̂. Steps are 0.4 rad, falling as a half cosine.
TEST(GradientDescent, TakesTheStepsOfAdam) {
  const Slm slm = make_panel(32, 24, 65536);  // levels so fine that rounding is negligible
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.004}};
  params.iterations = 6;
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  Hologram hologram = blank_hologram(slm);
  CounterRandom random(6, 0, 0);
  for (uint16_t& level : hologram.level.values) level = uint16_t(20000 + 20000 * random.uniform());
  const double power = target_power(targets.front()), radian = 65536 / (2 * pi);
  Array2D<float> drive(24, 32);
  for (size_t i = 0; i < drive.size(); ++i) drive.values[i] = hologram.level.values[i];
  std::vector<double> m(drive.size()), v(drive.size());
  for (int t = 1; t <= params.iterations; ++t) {
    Array2D<float> slope(24, 32);
    loss(targets, slm, hologram, drive, &slope);
    const double step = 0.4 * radian * (1 + std::cos(pi * (t - 1) / params.iterations)) / 2;
    for (size_t i = 0; i < drive.size(); ++i) {
      const double d = slope.values[i] / power;
      m[i] = 0.9 * m[i] + 0.1 * d;
      v[i] = 0.99 * v[i] + 0.01 * d * d;
      drive.values[i] -= float(step * (m[i] / (1 - std::pow(0.9, t))) / std::sqrt(v[i] / (1 - std::pow(0.99, t))));
    }
  }
  std::vector<Hologram> frames{hologram};
  descend({targets}, slm, params, {}, frames);
  // The six steps are 0.4 … 0.03 rad; without the corrections they would be a quarter to two thirds longer. Levels are
  // 1e-4 rad apart. Floats may flip a few slopes near 0, which Adam scales up like all others: compare quantiles.
  std::vector<double> apart;
  for (size_t i = 0; i < drive.size(); ++i)
    apart.push_back(std::abs(std::remainder(frames[0].level.values[i] - drive.values[i], 65536.0)) / radian);
  std::sort(apart.begin(), apart.end());
  EXPECT_LT(apart[apart.size() / 2], 2e-4);
  EXPECT_LT(apart[apart.size() * 9 / 10], 1e-3);
}

// Each colour counts alike, and the reported efficiency is their mean.
TEST(GradientDescent, MeansOverColours) {
  Slm slm = make_panel(64, 48);
  slm.design_wavelength = 633e-9;
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.006}};
  params.iterations = 1;
  const TargetPlane green = picture_targets(slm, params).front(), red = picture_targets(slm, params, 633e-9).front();
  const auto told = [&](const std::vector<TargetPlane>& targets) {
    std::vector<Hologram> frames{blank_hologram(slm)};
    for (size_t i = 0; i < frames[0].level.size(); ++i) frames[0].level.values[i] = uint16_t(i * i % 256);
    Heard heard;
    judge(targets, slm, params, heard.observer(), frames);
    const double efficiency = heard.number("target_efficiency");
    descend({targets}, slm, params, heard.observer(), frames);
    return std::pair(efficiency, heard.number("loss_first"));
  };
  const auto of_green = told({green}), of_red = told({red}), of_both = told({green, red});
  ASSERT_GT(std::abs(of_green.first - of_red.first), 0.01 * of_red.first);  // else the mean proves nothing
  EXPECT_NEAR(of_both.first, (of_green.first + of_red.first) / 2, 1e-5);
  EXPECT_NEAR(of_both.second, (of_green.second + of_red.second) / 2, 1e-5);
}

TEST(GradientDescent, SameBytesOnAnyNumberOfThreads) {
  const Slm slm = make_panel(96, 64);
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.01}};
  params.iterations = 10;
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  const Field start = field_of_target(targets[0], slm, params);
  std::vector<AlignedVector<uint16_t>> levels;
  for (const size_t threads : {1, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    levels.push_back(encode_targets(targets, start, slm, params).level.values);
  }
  EXPECT_EQ(levels[0], levels[1]);
}

TEST(GradientDescent, OneHologramShowsAPlaneInEachOfTwoColours) {
  // Both at once is harder than one, and far better for the other colour than the hologram of one.
  Slm slm = make_panel(128, 96);
  slm.design_wavelength = 633e-9;
  slm.phase_range = 4 * pi;
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.01}, .target_columns = 80, .target_rows = 60};
  params.iterations = 60;
  std::vector<TargetPlane> targets = picture_targets(slm, params);
  const Field start = field_of_target(targets[0], slm, params);
  Heard joint, alone;
  targets.push_back(picture_targets(slm, params, 633e-9).front());
  encode_targets(targets, start, slm, params, joint.observer());
  std::vector<Hologram> of_one{encode_targets({targets[0]}, start, slm, params)};
  judge(targets, slm, params, alone.observer(), of_one);
  EXPECT_GT(joint.number("psnr_db"), alone.number("psnr_db") + 3);  // at most half the error's power
}

}  // namespace
}  // namespace holotrace
