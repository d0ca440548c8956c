#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <vector>

#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/gradient_descent.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/expose.h"
#include "holotrace/view/sensor.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/targets.h"

// Frames that are found together, measured by the virtual SLM and the sensor: the mean of their irradiances over the
// pixels of a plane.

namespace holotrace {
namespace {

EncodeParams descent(std::vector<double> distances, int iterations = 60) {
  EncodeParams params{.method = Encoding::sgd, .target_distances = std::move(distances)};
  params.target_columns = 96;
  params.target_rows = 64;
  params.iterations = iterations;
  return params;
}

struct Seen {
  double psnr;   // of the amplitude, at the best scale, relative to the largest wanted one [dB]
  double scale;  // that scale: 1 if the light has the brightness that is wanted
};

Seen look(const TargetPlane& target, const std::vector<Hologram>& frames, const Slm& slm) {
  std::vector<double> irradiance(target.amplitude.size());
  for (const Hologram& frame : frames) {
    const Field light = show(frame, slm, {.irradiance = frame.illumination});
    const Field there = propagate(light, target.z, window_of(light.grid, 2, integration_rim));
    const Image seen = mean_over_pixels(irradiance_of(there), 2, integration_rim, true);
    for (size_t i = 0; i < irradiance.size(); ++i) irradiance[i] += double(seen.values[i]) / double(frames.size());
  }
  double wanted = 0, cross = 0, square = 0, pixels = 0, peak = 0;
  for (size_t i = 0; i < irradiance.size(); ++i) {
    if (target.weight.size() > 0 && target.weight.values[i] == 0) continue;
    const double a = target.amplitude.values[i], v = std::sqrt(irradiance[i]);
    wanted += a * a;
    cross += a * v;
    square += v * v;
    pixels += 1;
    peak = std::max(peak, a);
  }
  return {10 * std::log10(peak * peak * pixels / (wanted - cross * cross / square)), cross / square};
}

std::vector<std::vector<uint16_t>> levels_of(const std::vector<Hologram>& frames) {
  std::vector<std::vector<uint16_t>> levels;
  for (const Hologram& frame : frames) levels.emplace_back(frame.level.values.begin(), frame.level.values.end());
  return levels;
}

TEST(JointFrames, FourReachWhatOneCannot) {
  // Two planes of 96 × 64 pixels ask for as much as one frame of 128 × 96 has phases; four frames have four times as many.
  // An error that is independent from frame to frame would fall by half: 3 dB in amplitude for each doubling. Here the
  // frames correct each other: 26 and 38 dB measured.
  const Slm slm = make_panel(128, 96);
  const EncodeParams params = descent({0.009, 0.011});
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  const auto psnr = [&](int frames) {
    const std::vector<Hologram> holograms = encode_frames({targets}, test_wavelength, frames, slm, params);
    return std::min(look(targets[0], holograms, slm).psnr, look(targets[1], holograms, slm).psnr);
  };
  EXPECT_GT(psnr(4), psnr(1) + 8);
}

// A ramp of one part in n per pixel is up to n/4 of its step from its samples: rms 1/4n along one axis.
TEST(JointFrames, TakeOneSampleOfAPixelOnlyIfTheTargetsAreSmooth) {
  const auto ramp = [](double step) {
    TargetPlane target;
    target.amplitude = Array2D<float>(40, 60);
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 60; ++i) target.amplitude(j, i) = float(1 - step * i);
    return target;
  };
  EXPECT_TRUE(is_smooth(ramp(0.0)));
  EXPECT_TRUE(is_smooth(ramp(1.0 / 26)) &&
              !is_smooth(ramp(1.0 / 24)));  // 1/4n is 1 %, less the last column's rest of 1 %
  TargetPlane part = ramp(0.0);             // pixels that do not count do not make it smoother
  part.amplitude(3, 3) = 0.2F;              // four steps of 0.8: 2.6/16 over 2400 pixels is 0.7e-4, over 800 it is 2e-4
  EXPECT_TRUE(is_smooth(part));
  EXPECT_EQ(target_peak(part), double(*std::max_element(part.amplitude.values.begin(), part.amplitude.values.end())));
  TargetPlane dim = part;  // light that does not count has no part in the peak
  dim.amplitude(3, 2) = 7;
  dim.weight = Array2D<float>(dim.amplitude.ny, dim.amplitude.nx, 1);
  EXPECT_EQ(target_peak(dim), 7);
  dim.weight(3, 2) = 0;
  EXPECT_LT(target_peak(dim), 7);
  part.weight = Array2D<float>(40, 60);
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 20; ++i) part.weight(j, i) = 1;
  EXPECT_FALSE(is_smooth(part));
  EXPECT_EQ(samples_of(samples_of_update(1, 0, true), 4).size(), 1u);
  EXPECT_EQ(samples_of(samples_of_update(1, 0, false), 4).size(), 2u);
  EXPECT_EQ(samples_of_update(3, 0, true), SampleGroup::all);  // several samples of the field in a pixel
  std::set<size_t> taken;
  for (uint64_t round = 0; round < 4; ++round)
    for (const size_t sample : samples_of(samples_of_update(1, round, true), 4)) taken.insert(sample);
  EXPECT_EQ(taken.size(), 4u);
  EXPECT_EQ(irradiance_factor(SampleGroup::third), 4);
}

// A gain of 100 dB is never reached, so the iterations end one window after the first two. A window has 10 updates or more, and the
// planes equally often: for two smooth planes with each of four single samples, 16; for one plane on both diagonals, 10.
TEST(JointFrames, CompareWindowsOfAllSamplesToEndEarly) {
  const Slm slm = make_panel(32, 24);
  EncodeParams params = descent({0.01}, 100);
  params.least_gain = 100;
  TargetPlane even;
  even.z = 0.01;
  even.amplitude = Array2D<float>(24, 32, 1);
  even.wavelength = test_wavelength;
  TargetPlane farther = even;
  farther.z = 0.011;
  const auto iterations = [&](int frames, const std::vector<TargetPlane>& planes) {
    Heard heard;
    encode_frames({planes}, test_wavelength, frames, slm, params, heard.observer());
    return std::get<int64_t>(heard.facts.at("iterations"));
  };
  EXPECT_EQ(iterations(4, {even, farther}), 3 * 16);
  EXPECT_EQ(iterations(1, {even, farther}), 3 * 16);
  EXPECT_EQ(iterations(1, {even}), 3 * 10);
}

// A step of 0 is that of the start (frame_start.h): 0.1 rad for 50 iterations from a smooth one, 0.4 rad from random phases; of
// four frames twice as much.
TEST(JointFrames, TakeTheStepOfTheirStart) {
  const Slm slm = make_panel(96, 64);
  EncodeParams params = descent({0.02}, 50);
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  const auto levels = [&](double step, int frames = 1) {
    params.step = step;
    return encode_frames({targets}, test_wavelength, frames, slm, params).front().level.values;
  };
  params.start = StartPhase::field;
  EXPECT_EQ(levels(0), levels(0.1));
  EXPECT_NE(levels(0), levels(0.4));
  params.start = StartPhase::random;
  EXPECT_EQ(levels(0), levels(0.4));
  EXPECT_EQ(levels(0, 4), levels(0.8, 4));
}

TEST(JointFrames, ShowPlanesBetweenTheTargets) {
  // The light of the panel's band has a depth of focus of λ/NA² = 4p²/λ = 0.48 mm. A plane in the middle of two targets
  // 0.2 mm apart is as good as they are: 39 dB measured. Aimed at one of them alone, it is not: 30 dB.
  const Slm slm = make_panel(128, 96);
  const EncodeParams both = descent({0.0099, 0.0101}), one = descent({0.0099});
  const std::vector<TargetPlane> targets = picture_targets(slm, both);
  TargetPlane between = targets[0];
  between.z = -0.01;
  const std::vector<Hologram> frames = encode_frames({targets}, test_wavelength, 4, slm, both);
  const double at_targets = look(targets[0], frames, slm).psnr, psnr = look(between, frames, slm).psnr;
  const double with_one =
      look(between, encode_frames({picture_targets(slm, one)}, test_wavelength, 4, slm, one), slm).psnr;
  EXPECT_GT(psnr, at_targets - 3);
  EXPECT_GT(psnr, with_one + 3);
}

TEST(JointFrames, HaveTheBrightnessOfTheTarget) {
  // Through pixels that let 0.9² of the light pass, with targets of any brightness. The light over pixels is integrated in
  // two ways (target_propagation.h), which differ by the finest detail: 1 % of the amplitude.
  const Slm slm = make_panel(128, 96, 256, 0.9);
  const EncodeParams params = descent({0.01}, 30);
  for (const float brightness : {1.0F, 300.0F}) {
    std::vector<TargetPlane> targets = picture_targets(slm, params);
    for (float& a : targets.front().amplitude.values) a *= std::sqrt(brightness);
    const std::vector<Hologram> frames = encode_frames({targets}, test_wavelength, 2, slm, params);
    EXPECT_EQ(frames[0].illumination, frames[1].illumination);
    EXPECT_NEAR(look(targets.front(), frames, slm).scale, 1, 0.01) << brightness;
  }
}

TEST(JointFrames, MoreLevelsShowMore) {
  double before = 20;  // two levels: more than 20 dB
  for (const int levels : {2, 4, 16, 256}) {
    const Slm slm = make_panel(128, 96, levels);
    const EncodeParams params = descent({0.009, 0.011});
    const std::vector<TargetPlane> targets = picture_targets(slm, params);
    const std::vector<Hologram> frames = encode_frames({targets}, test_wavelength, 4, slm, params);
    for (const std::vector<uint16_t>& values : levels_of(frames)) {
      EXPECT_EQ(std::set<uint16_t>(values.begin(), values.end()).size(), size_t(levels));  // all are used, and no other
      EXPECT_LT(*std::max_element(values.begin(), values.end()), levels);
    }
    const double psnr = look(targets[0], frames, slm).psnr;
    EXPECT_GT(psnr, before) << levels;
    before = psnr;
  }
}

TEST(JointFrames, OneFrameIsTheHologramOfItsTargets) {
  const Slm slm = make_panel(96, 64);
  EncodeParams params = descent({0.01, 0.012}, 10);
  params.start = StartPhase::random;
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  const std::vector<Hologram> frames = encode_frames({targets}, test_wavelength, 1, slm, params);
  const Hologram hologram = encode_targets(targets, Field(slm.grid, test_wavelength), slm, params);
  EXPECT_EQ(frames.front().level.values, hologram.level.values);
  EXPECT_EQ(frames.front().illumination, hologram.illumination);
}

TEST(JointFrames, TheMeanOfEqualFramesIsOneOfThem) {
  const Slm slm = make_panel(96, 64);
  const EncodeParams params = descent({0.01, 0.012}, 10);
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  const std::vector<Hologram> frames = encode_frames({targets}, test_wavelength, 2, slm, params);
  EXPECT_NE(frames[0].level.values, frames[1].level.values);  // each has its own start
  const auto psnr = [&](std::vector<Hologram> shown) {
    Heard heard;
    judge(targets, slm, params, heard.observer(), shown);
    return heard.number("psnr_db");
  };
  EXPECT_NEAR(psnr({frames[0], frames[0], frames[0]}), psnr({frames[0]}), 1e-3);  // float
  EXPECT_GT(psnr(frames), psnr({frames[0]}) + 1);  // independent errors would be 3 dB less
}

TEST(JointFrames, SameBytesOnAnyNumberOfThreads) {
  const Slm slm = make_panel(96, 64);
  const EncodeParams params = descent({0.01, 0.011, 0.012}, 8);
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  std::vector<std::vector<std::vector<uint16_t>>> levels;
  for (const size_t threads : {1, 3}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    levels.push_back(levels_of(encode_frames({targets}, test_wavelength, 3, slm, params)));
  }
  EXPECT_EQ(levels[0], levels[1]);
}

// What an optimisation with so many planes per update reports, and its levels.
struct Updates {
  double loss_first;
  std::vector<double> convergence;
  std::vector<std::vector<uint16_t>> levels;
};

Updates run(const std::vector<TargetPlane>& targets, const Slm& slm, EncodeParams params, int planes_per_update) {
  params.planes_per_update = planes_per_update;
  Updates run;
  Heard heard;
  Observer observer = heard.observer();
  observer.on_curve = [&](const std::string&, const std::vector<double>& values) { run.convergence = values; };
  run.levels = levels_of(encode_frames({targets}, test_wavelength, 2, slm, params, observer));
  run.loss_first = heard.number("loss_first");
  return run;
}

TEST(JointFrames, ZeroPlanesPerUpdateMeansAll) {
  const Slm slm = make_panel(96, 64);
  EncodeParams params = descent({0.01, 0.011, 0.012}, 8);
  params.start = StartPhase::random;  // equally far from the targets of all planes
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  const Updates all = run(targets, slm, params, 0);
  EXPECT_EQ(run(targets, slm, params, 3).levels, all.levels);
  EXPECT_EQ(run(targets, slm, params, 7).levels, all.levels);
  const Updates one = run(targets, slm, params, 1);
  EXPECT_NE(one.levels, all.levels);
  // Planes count before their first turn; without them the loss would be a third. That of the plane in the first update
  // is for a scale where this plane counts more than the others: 1 %.
  EXPECT_NEAR(one.loss_first, all.loss_first, 0.01 * all.loss_first);
}

// Only one plane has any weight, so the loss changes with its turns alone. Each plane takes its turn once in each round,
// no two at once, and not in the same order in all rounds.
TEST(JointFrames, EachPlaneHasItsTurnInEachRound) {
  constexpr size_t planes = 4, rounds = 6;
  const Slm slm = make_panel(48, 32);
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.008, 0.009, 0.01, 0.011}};
  params.iterations = int(planes * rounds);
  std::vector<std::vector<size_t>> order(rounds, std::vector<size_t>(planes, planes));
  for (size_t k = 0; k < planes; ++k) {
    std::vector<TargetPlane> targets = picture_targets(slm, params);
    for (size_t other = 0; other < planes; ++other)
      if (other != k) targets[other].weight = Array2D<float>(32, 48);
    const std::vector<double> loss = run(targets, slm, params, 1).convergence;
    for (size_t i = planes; i < planes * rounds;
         ++i) {  // in the first round, the levels may still be those of the start
      if (loss[i] == loss[i - 1]) continue;
      EXPECT_EQ(order[i / planes][i % planes], planes) << "two planes in update " << i;
      order[i / planes][i % planes] = k;
    }
  }
  std::set<std::vector<size_t>> orders;
  for (size_t r = 1; r < rounds; ++r) {
    orders.insert(order[r]);
    std::vector<size_t> sorted = order[r];
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, (std::vector<size_t>{0, 1, 2, 3})) << "round " << r;
  }
  EXPECT_GT(orders.size(), 1u);
}

// Light of one sample per pixel that leaves the panel, before the aperture of its pixels.
Field light_of(const Hologram& frame) {
  Field light(frame.grid, frame.wavelength);
  for (size_t i = 0; i < light.samples.size(); ++i)
    light.samples.values[i] = std::complex<float>(std::polar(1.0, 2 * pi * frame.level.values[i] / frame.levels));
  return light;
}

// The light of frames through some pupils, each picture's irradiance, times the irradiance that shows the planes.
std::vector<Array2D<float>> views_of(const std::vector<Hologram>& frames, const Slm& slm, const ViewTargets& views) {
  const PupilPropagation to_eyes(slm, test_wavelength, views.window, views.pupils.front().centre.z, {});
  std::vector<Array2D<float>> light(views.pupils.size(), Array2D<float>(views.picture.ny, views.picture.nx));
  for (const Hologram& frame : frames) {
    const Field eye = to_eyes.to_eye(light_of(frame));
    for (size_t k = 0; k < light.size(); ++k)
      add_power(take_picture(eye, views.pupils[k], views.z, views.picture).values.data(),
                float(frame.illumination / double(frames.size())), light[k].values.data(), light[k].size());
  }
  return light;
}

// Σ(A − a)²/Σa² over all pictures.
double error_of_views(const std::vector<Hologram>& frames, const Slm& slm, const ViewTargets& views) {
  const std::vector<Array2D<float>> light = views_of(frames, slm, views);
  double error = 0, power = 0;
  for (size_t k = 0; k < light.size(); ++k)
    for (size_t i = 0; i < light[k].size(); ++i) {
      const double a = views.amplitudes[k].values[i];
      error += std::pow(std::sqrt(double(light[k].values[i])) - a, 2);
      power += a * a;
    }
  return error / power;
}

// Each update uses views that are drawn for it. The views are even, with the light that frames without
// views send through each pupil: what is left to gain is their speckle.
TEST(JointFrames, EachUpdateDrawsViews) {
  const Slm slm = make_panel(128, 96);
  const EncodeParams params = descent({0.01}, 80);
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  ViewTargets views{.z = targets.front().z,
                    .wavelength = test_wavelength,
                    .window = window_of_pupils(slm.grid, 3e-4),
                    .picture = {},
                    .pupils = {},
                    .amplitudes = {}};
  for (const double x : {-1.5e-4, 1.5e-4}) views.pupils.push_back({{x, 0, 0.02}, 3e-4});
  views.picture =
      picture_grid(slm.grid, slm.grid.width(), slm.grid.height(), views.pupils.front(), test_wavelength, views.z);
  const std::vector<Hologram> without = encode_frames({targets}, test_wavelength, 4, slm, params);
  for (const Array2D<float>& light : views_of(without, slm, views)) {
    const double mean = std::accumulate(light.values.begin(), light.values.end(), 0.0) / double(light.size());
    views.amplitudes.emplace_back(light.ny, light.nx);
    for (float& a : views.amplitudes.back().values) a = float(std::sqrt(mean));
  }
  std::vector<int> updates;
  const auto draw = [&](int update, double wavelength) {
    EXPECT_EQ(wavelength, test_wavelength);
    updates.push_back(update);
    return views;
  };
  const std::vector<Hologram> with = encode_frames({targets, {}, draw}, test_wavelength, 4, slm, params);
  // At least half of the error of the views goes.
  EXPECT_LT(error_of_views(with, slm, views), error_of_views(without, slm, views) / 2);
  ASSERT_EQ(updates.size(), 80u);
  for (int i = 0; i < 80; ++i) EXPECT_EQ(updates[size_t(i)], i);
}

TEST(JointFrames, SayWhatIsWrong) {
  const Slm slm = make_panel(8, 6);
  EncodeParams params{.method = Encoding::sgd, .target_distances = {0.001}};
  const std::vector<TargetPlane> targets = picture_targets(slm, params);
  EXPECT_EQ(error_of([&] { encode_frames({targets}, test_wavelength, 0, slm, params); }),
            "expected at least one frame, got 0");
  EXPECT_EQ(error_of([&] { encode_frames({}, test_wavelength, 2, slm, params); }),
            "expected a target for the image, got none");
  params.method = Encoding::gerchberg_saxton;
  EXPECT_EQ(error_of([&] { encode_frames({targets}, test_wavelength, 2, slm, params); }),
            "expected the method sgd for frames that are found together, got \"gerchberg-saxton\"");
}

TEST(JointFrames, ADarkTargetMakesDarkFrames) {
  const Slm slm = make_panel(8, 6);
  const EncodeParams params{.method = Encoding::sgd, .target_distances = {0.001}};
  Heard heard;
  const auto frames = encode_frames({targets_of_picture(Image(6, 8, 1), slm.grid, test_wavelength, params)},
                                    test_wavelength, 2, slm, params, heard.observer());
  ASSERT_EQ(frames.size(), 2u);
  for (const Hologram& frame : frames) EXPECT_EQ(frame.illumination, 0);
  EXPECT_EQ(heard.warnings.size(), 1u);
}

}  // namespace
}  // namespace holotrace
