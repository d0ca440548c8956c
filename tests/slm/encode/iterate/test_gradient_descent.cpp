#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "holotrace/slm/encode/iterate/gradient_descent.h"
#include "support/descent.h"
#include "support/devices.h"

namespace holotrace {
namespace {

Hologram blank_hologram(const Slm& slm) {
  return make_hologram(slm, Modulation::phase, [](int) { return 0; });
}

// On the processor and on every device.
class GradientDescentOn : public ::testing::TestWithParam<DeviceChoice> {};

INSTANTIATE_TEST_SUITE_P(Devices, GradientDescentOn, ::testing::ValuesIn(test::processor_and_devices()),
                         test::device_name_of);

// Kingma and Ba (2015), algorithm 1, in double, with its two corrections as written there:
// m̂ = m/(1 − β₁ᵗ), v̂ = v/(1 − β₂ᵗ), x ← x − α·m̂/√v̂. Steps are 0.4 rad, falling as a half cosine. One frame and three,
// a stop; several samples of the field per pixel, which updates take all at once. (The scale of several targets together is not
// that of each: one target.)
TEST_P(GradientDescentOn, TakesTheStepsOfAdam) {
  const Slm slm = make_panel(32, 24, 65536);  // levels so fine that rounding is negligible
  struct Case {
    int frames, subpixels;
    double stop;
  };
  for (const auto& [count, subpixels, stop] : {Case{1, 3, 0}, {3, 3, 0.6}, {2, 2, 0}}) {
    EncodeParams params{
        .method = Encoding::sgd, .stop = stop, .target_distances = {0.004}, .iterations = 6, .subpixels = subpixels};
    params.device = GetParam();
    std::vector<TargetPlane> targets = picture_targets(slm, params);
    std::vector<Hologram> frames(size_t(count), blank_hologram(slm));
    std::vector<Drive> drives, slopes;
    CounterRandom random(6, 0, 0);
    for (Hologram& frame : frames) {
      drives.push_back({Array2D<float>(24, 32), {}});
      for (size_t i = 0; i < frame.level.size(); ++i)
        drives.back().level.values[i] = frame.level.values[i] = uint16_t(20000 + 20000 * random.uniform());
    }
    const Descent descent{targets, slm, params, frames.front()};
    const double power = target_power(targets.front()), radian = 65536 / (2 * pi);
    std::vector<std::vector<double>> m(frames.size(), std::vector<double>(drives.front().level.size())), v = m;
    for (int t = 1; t <= params.iterations; ++t) {
      descent.loss(drives, &slopes);
      const double step = 0.4 * radian * (1 + std::cos(pi * (t - 1) / params.iterations)) / 2;
      for (size_t f = 0; f < frames.size(); ++f)
        for (size_t i = 0; i < drives[f].level.size(); ++i) {
          const double d = slopes[f].level.values[i] / power;
          m[f][i] = 0.5 * m[f][i] + 0.5 * d;
          v[f][i] = 0.99 * v[f][i] + 0.01 * d * d;
          drives[f].level.values[i] -=
              float(step * (m[f][i] / (1 - std::pow(0.5, t))) / std::sqrt(v[f][i] / (1 - std::pow(0.99, t))));
        }
    }
    descend({targets}, slm, params, {}, frames);
    // The six steps are 0.4 … 0.03 rad; without the corrections they would be 4 to 5 times as long. Levels are
    // 1e-4 rad apart. Floats may flip a few slopes near 0, which Adam scales up like all others: compare quantiles.
    std::vector<double> apart;
    for (size_t f = 0; f < frames.size(); ++f)
      for (size_t i = 0; i < drives[f].level.size(); ++i)
        apart.push_back(std::abs(std::remainder(frames[f].level.values[i] - drives[f].level.values[i], 65536.0)) /
                        radian);
    std::sort(apart.begin(), apart.end());
    EXPECT_LT(apart[apart.size() / 2], 2e-4) << count;
    EXPECT_LT(apart[apart.size() * 9 / 10], 1e-3) << count;
  }
}

// The iterations end early where the mean loss of a window is not lower by least_gain than that of the window before. The
// step falls to 0 all the same, so the last update changes the loss by little.
TEST(GradientDescent, EndsEarlyIfLittleIsGained) {
  const Slm slm = make_panel(64, 48);
  EncodeParams params{
      .method = Encoding::sgd, .target_distances = {0.006}, .iterations = 200, .start = StartPhase::random};
  const auto told = [&](double least_gain) {
    params.least_gain = least_gain;
    Heard heard;
    std::vector<double> convergence;
    Observer observer = heard.observer();
    observer.on_curve = [&](const std::string&, const std::vector<double>& values) { convergence = values; };
    encode_frames({picture_targets(slm, params)}, test_wavelength, 1, slm, params, observer);
    return convergence;  // before each iteration, and at the end
  };
  const std::vector<double> whole = told(0), early = told(0.5);
  ASSERT_EQ(whole.size(), 201u);
  ASSERT_LT(early.size(), 201u);
  ASSERT_GE(early.size(), 31u);  // two windows of 10 to compare, and one to end
  const size_t last = early.size() - 1, begins = last - 10;
  EXPECT_EQ(early[begins], whole[begins]);
  EXPECT_LT(early[last], early[begins]);
  // Updates take the two diagonals of the pixels in turn: those of one are compared.
  EXPECT_LT(std::abs(early[last - 1] - early[last - 3]), std::abs(early[begins + 2] - early[begins]) / 3);
  const auto gain = [&](size_t end) {  // of the window that ends there [dB]
    const auto mean = [&](size_t to) { return std::accumulate(&whole[to - 10], &whole[to], 0.0) / 10; };
    return 10 * std::log10(mean(end - 10) / mean(end));
  };
  EXPECT_LT(gain(begins), 0.5);
  for (size_t end = 20; end < begins; ++end) EXPECT_GE(gain(end), 0.5) << end;
}

// Few levels: the light is that of soft levels at first. Loss at the end against rounding from the start, measured on
// this panel at 4 levels: see the bound.
TEST_P(GradientDescentOn, EndsOnWholeLevels) {
  const bool is_device = GetParam().kind != DeviceKind::cpu;
  // PoCL takes a second for ten updates.
  for (const int levels : is_device ? std::vector{3} : std::vector{2, 3, 4, 16}) {
    const Slm slm = make_panel(64, 48, levels);
    EncodeParams params{.method = Encoding::sgd, .target_distances = {0.006}, .iterations = is_device ? 10 : 40};
    params.device = GetParam();
    const std::vector<TargetPlane> targets = picture_targets(slm, params);
    std::vector<Hologram> frames = encode_frames({targets}, test_wavelength, 2, slm, params);
    for (const Hologram& frame : frames)
      EXPECT_LT(*std::max_element(frame.level.values.begin(), frame.level.values.end()), levels);
    Heard of_descent, of_levels;
    frames = encode_frames({targets}, test_wavelength, 2, slm, params, of_descent.observer());
    judge(targets, slm, params, of_levels.observer(), frames);  // the levels as they are saved
    // The processor judges the levels: its light differs by rounding, 2e-6 of the error or 1e-5 dB, and more at low errors.
    EXPECT_NEAR(of_descent.number("psnr_db"), of_levels.number("psnr_db"), is_device ? 1e-4 : 0) << levels;
  }
}

// A complex panel can show any light of its band: it has twice the degrees of freedom of a phase panel, which has too few where
// the whole window counts.
TEST(GradientDescent, ComplexPanelsShowMore) {
  Slm slm = make_panel(96, 64);
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.006}};
  params.iterations = 40;
  const auto psnr = [&](Modulation modulation) {
    slm.modulation = modulation;
    Heard heard;
    const std::vector<TargetPlane> targets = picture_targets(slm, params);
    const Hologram hologram =
        encode_targets(targets, field_of_target(targets[0], slm, params), slm, params, heard.observer());
    EXPECT_EQ(hologram.modulation, modulation);
    EXPECT_EQ(hologram.modulus_level.size(), modulation == Modulation::complex ? hologram.level.size() : 0);
    return heard.number("psnr_db");
  };
  EXPECT_GT(psnr(Modulation::complex), psnr(Modulation::phase) + 3);  // half of the error, or less
}

TEST(GradientDescent, ComplexPanelsStartAtTheFieldsModulus) {
  Slm slm = make_panel(16, 12);
  slm.modulation = Modulation::complex;
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.006}};
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  Field start(slm.grid, test_wavelength);
  for (size_t i = 0; i < start.samples.size(); ++i) start.samples.values[i] = float(i % 4 + 1);
  params.iterations = 1;
  params.step = 1e-9;  // radians: no level changes
  const Hologram hologram = encode_targets(targets, start, slm, params);
  for (size_t i = 0; i < hologram.modulus_level.size(); ++i)
    EXPECT_NEAR(hologram.modulus_level.values[i], 255 * (i % 4 + 1) / 4.0, 0.5001) << i;  // rounding
}

TEST(GradientDescent, RefusesTwoLevelsOfAComplexPanel) {
  Slm slm = make_panel(16, 12, 2);
  slm.modulation = Modulation::complex;
  const EncodeParams params{.method = Encoding::sgd, .target_distances = {0.006}, .iterations = 1};
  EXPECT_EQ(error_of([&] { encode_frames({picture_targets(slm, params)}, test_wavelength, 1, slm, params); }),
            "expected more than 2 levels for sgd on a complex panel, got 2; use more levels, or the method binary");
}

// A colour without light is not lit, however bright the others are.
TEST_P(GradientDescentOn, DarkColoursOfAJointHologramStayDark) {
  const Slm slm = make_panel(48, 32);
  const EncodeParams params{
      .method = Encoding::sgd, .target_distances = {0.006}, .iterations = 2, .device = GetParam()};
  TargetPlane green = picture_targets(slm, params).front(), red = picture_targets(slm, params, 633e-9).front();
  std::fill(red.amplitude.values.begin(), red.amplitude.values.end(), 0.0F);
  const Hologram joint = encode_frames({{green, red}}, test_wavelength, 1, slm, params).front();
  ASSERT_EQ(joint.colours.size(), 2u);
  EXPECT_GT(joint.colours[0].illumination, 0);
  EXPECT_EQ(joint.colours[1].illumination, 0);
}

// Each colour counts alike, and the reported efficiency is their mean.
TEST_P(GradientDescentOn, MeansOverColours) {
  Slm slm = make_panel(64, 48);
  slm.design_wavelength = 633e-9;
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.006}};
  params.iterations = 1;
  params.device = GetParam();
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
  TargetPlane bright = red;  // the same light nine times as bright counts the same
  for (float& a : bright.amplitude.values) a *= 3;
  EXPECT_NEAR(told({bright}).second, of_red.second, 1e-5);
  EXPECT_NEAR(told({green, bright}).second, of_both.second, 1e-5);
}

// Amplitude levels have no phase, so the step is a part of the way from dark to bright. A start of random levels shows a
// bright plane with speckle; the levels that are found show the picture, to a fifth of that error.
TEST(GradientDescent, FindsTheLevelsOfAnAmplitudePanel) {
  Slm slm = make_panel(96, 64);
  slm.modulation = Modulation::amplitude;
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.006}, .target_columns = 64, .target_rows = 40};
  params.iterations = 60;
  std::vector<Hologram> frames{make_hologram(slm, Modulation::amplitude, [](int) { return 0; })};
  CounterRandom random(6, 0, 0);
  for (uint16_t& level : frames[0].level.values) level = uint16_t(256 * random.uniform());
  Heard heard;
  descend({picture_targets(slm, params)}, slm, params, heard.observer(), frames);
  EXPECT_LT(heard.number("loss_last"), heard.number("loss_first") / 5);
  EXPECT_LT(*std::max_element(frames[0].level.values.begin(), frames[0].level.values.end()), 256);
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
