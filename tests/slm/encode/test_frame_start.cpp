#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "holotrace/slm/encode/blank_hologram.h"
#include "holotrace/slm/encode/frame_start.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/panels.h"

namespace holotrace {
namespace {

constexpr double lens = 0.02;  // distance of the plane: λz/2p is 0.67 mm, the panel 0.77 mm × 0.51 mm

TargetSet one_plane(const Slm& slm, double z) {
  TargetPlane plane{z, test_wavelength, Array2D<float>(slm.grid.ny, slm.grid.nx), {}};
  for (int j = 16; j < 48; ++j)
    for (int i = 24; i < 72; ++i) plane.amplitude(j, i) = float(0.6 + 0.4 * std::sin(i / 6.0) * std::cos(j / 5.0));
  return {{plane}};
}

EncodeParams descent() {
  EncodeParams params;
  params.method = Encoding::sgd;
  return params;
}

FrameStart start_with(const TargetSet& targets, int frames, const Slm& slm, const EncodeParams& params) {
  return start_of_frames(targets, test_wavelength, frames, slm, params);
}

TEST(FrameStart, IsSmoothWhereDoublePhasesHaveRoom) {
  const Slm slm = make_panel(96, 64);
  const EncodeParams params = descent();
  EXPECT_EQ(start_with(one_plane(slm, -lens), 4, slm, params), FrameStart::smooth);
  EXPECT_EQ(start_with(one_plane(slm, lens), 4, slm, params), FrameStart::smooth);
  // 0.7 of 0.512 mm, at 10.78 mm.
  EXPECT_EQ(start_with(one_plane(slm, -0.0109), 4, slm, params), FrameStart::smooth);
  EXPECT_EQ(start_with(one_plane(slm, -0.0107), 4, slm, params), FrameStart::speckle);
  EXPECT_EQ(start_with(one_plane(slm, -0.001), 1, slm, params), FrameStart::smooth);
}

TEST(FrameStart, DependsOnPanelTargetsAndParameters) {
  const Slm slm = make_panel(96, 64);
  const TargetSet targets = one_plane(slm, -lens);
  EncodeParams params = descent();
  params.levels = 4;
  EXPECT_EQ(start_with(targets, 1, slm, params), FrameStart::speckle);
  params.levels = 5;
  EXPECT_EQ(start_with(targets, 1, slm, params), FrameStart::smooth);
  params.start = StartPhase::random;
  EXPECT_EQ(start_with(targets, 1, slm, params), FrameStart::random);
  Slm amplitudes = slm;
  amplitudes.modulation = Modulation::amplitude;
  EXPECT_EQ(start_with(targets, 1, amplitudes, descent()), FrameStart::speckle);
  // Crosstalk that the levels allow for: by default that of the panel's own file.
  Slm blurred = slm;
  blurred.effects.crosstalk = 0.1;
  EXPECT_EQ(start_with(targets, 1, blurred, descent()), FrameStart::smooth);
  blurred.own_effects = {"crosstalk"};
  EXPECT_EQ(start_with(targets, 1, blurred, descent()), FrameStart::random);
  params = descent();
  params.effects = {"none"};
  EXPECT_EQ(start_with(targets, 1, blurred, params), FrameStart::smooth);
  blurred.modulation = Modulation::complex;
  EXPECT_EQ(start_with(one_plane(slm, -0.001), 4, blurred, descent()), FrameStart::smooth);
  Slm complex = slm;
  complex.modulation = Modulation::complex;
  EXPECT_EQ(start_with(one_plane(slm, -0.001), 4, complex, descent()), FrameStart::smooth);  // without a second term
  TargetSet colours = targets;
  colours.planes.push_back(colours.planes.front());
  colours.planes.back().wavelength = 633e-9;
  EXPECT_EQ(start_with(colours, 1, slm, descent()), FrameStart::speckle);
  TargetSet everywhere = targets;
  everywhere.draw_views = [](int, double) { return ViewTargets{}; };
  EXPECT_EQ(start_with(everywhere, 1, slm, descent()), FrameStart::speckle);
  everywhere.eyes = {{0, 0, 0.25}};
  EXPECT_EQ(start_with(everywhere, 1, slm, descent()), FrameStart::converging);
}

// Two planes whose reciprocal distances differ by Δ are Δ·w²/2λ depths of focus apart: 0.5543 for 1/m and w = 0.768 mm.
TEST(FrameStart, StepGrowsWithDepthIterationsAndFrames) {
  const Slm slm = make_panel(96, 64);
  TargetSet targets = one_plane(slm, -lens);
  const auto step = [&](FrameStart start, int iterations, int frames = 1) {
    return step_from(start, targets, slm.grid, iterations, frames);
  };
  EXPECT_NEAR(step(FrameStart::smooth, 50), 0.1, 1e-12);
  EXPECT_NEAR(step(FrameStart::smooth, 200), 0.2, 1e-12);
  EXPECT_EQ(step(FrameStart::smooth, 2000), sgd_step);
  EXPECT_EQ(step(FrameStart::random, 50), sgd_step);
  EXPECT_EQ(step(FrameStart::speckle, 50), sgd_step);
  EXPECT_EQ(step(FrameStart::converging, 50), 0.2);
  EXPECT_NEAR(step(FrameStart::smooth, 50, 3), 0.1 * std::sqrt(3), 1e-12);
  EXPECT_NEAR(step(FrameStart::smooth, 2000, 24), 2 * sgd_step, 1e-12);
  EXPECT_NEAR(step(FrameStart::speckle, 50, 2), sgd_step * std::sqrt(2), 1e-12);
  EXPECT_EQ(step(FrameStart::converging, 50, 4), 0.2);
  TargetSet everywhere = targets;
  everywhere.draw_views = [](int, double) { return ViewTargets{}; };
  EXPECT_EQ(step_from(FrameStart::speckle, everywhere, slm.grid, 50, 4), sgd_step);
  targets.planes.push_back(targets.planes.front());
  targets.planes.back().z = -1 / (1 / lens + 64.94);  // 36 depths of focus in front: one and a half times shallow ones
  EXPECT_NEAR(step(FrameStart::smooth, 50), 0.15, 1e-4);
}

// The light of a frame's start, in the plane.
Field shown(const Slm& slm, const TargetSet& targets, const FrameOfMany& which, const EncodeParams& params) {
  Hologram hologram = blank_hologram(Field(slm.grid, test_wavelength), slm, params, {});
  write_frame_start(FrameStart::smooth, targets, which, slm, params, PhaseLevels(slm, 256, test_wavelength), hologram);
  Field field(slm.grid, test_wavelength);
  for (size_t i = 0; i < field.samples.size(); ++i)
    field.samples.values[i] = std::polar(1.0F, float(2 * pi * hologram.level.values[i] / 256));
  return propagate(field, targets.planes.front().z);
}

// Correlation of moduli with the target's, in its lit part: 1 for a picture of the same shape.
double likeness_where_lit(const Field& light, const TargetPlane& target) {
  double cross = 0, of_light = 0, of_target = 0;
  for (size_t i = 0; i < light.samples.size(); ++i) {
    const double a = target.amplitude.values[i], b = std::abs(light.samples.values[i]);
    if (a == 0) continue;
    cross += a * b;
    of_light += b * b;
    of_target += a * a;
  }
  return cross / std::sqrt(of_light * of_target);
}

// Without iterations, the middle plane has the picture already, on both sides of the panel. Random phases have √(π/4) = 0.89.
TEST(FrameStart, SmoothOnesShowThePicture) {
  const Slm slm = make_panel(96, 64);
  for (const double z : {-lens, lens}) {
    EncodeParams params = descent();
    params.image = z > 0 ? ImageSide::real_image : ImageSide::virtual_image;
    const TargetSet targets = one_plane(slm, z);
    EXPECT_GT(likeness_where_lit(shown(slm, targets, {0, 1}, params), targets.planes.front()), 0.98) << z;
  }
}

// Eight frames go through the middles of 4 × 2 cells of a panel of 0.768 mm × 0.512 mm, of which light reaches λz/2p = 0.665 mm:
// (±0.125, ±0.375)·0.665 mm and ±0.25·0.512 mm. The light in the plane then has the frequencies of its middle's way to these
// places, X/λz.
TEST(FrameStart, FramesDifferByTheirTilt) {
  const Slm slm = make_panel(96, 64);
  const TargetSet targets = one_plane(slm, -lens);
  const Grid& g = slm.grid;
  for (int frame = 0; frame < 8; ++frame) {
    const Field light = shown(slm, targets, {frame, 8}, descent());
    std::complex<double> right = 0, up = 0;  // of neighbours in the lit part
    for (int j = 20; j < 44; ++j)
      for (int i = 28; i < 68; ++i) {
        right += std::complex<double>(light.samples(j, i + 1)) * std::conj(std::complex<double>(light.samples(j, i)));
        up += std::complex<double>(light.samples(j, i)) * std::conj(std::complex<double>(light.samples(j + 1, i)));
      }
    const double per_pixel = 2 * pi * test_pitch / (test_wavelength * lens);
    EXPECT_NEAR(std::arg(right), per_pixel * (frame % 4 - 1.5) / 4 * 0.665e-3, 0.15) << frame;
    EXPECT_NEAR(std::arg(up), per_pixel * (frame / 4 - 0.5) / 2 * g.height(), 0.15) << frame;
  }
}

// An eye at (0.1, −0.05) mm, 20 mm before the panel, sees a plane 30 mm behind it through the panel's place p at e + 2.5·(p − e).
// There the picture has the modulus 1 above y = 0.06 mm, 0.5 below it to the left of x = 0.2 mm, and 0 to the right: on the
// panel these edges are at y = −0.006 mm and x = 0.14 mm. Pairs of double phases have that mean, on the phase that
// converges to the eye.
TEST(FrameStart, ConvergingOnesHaveTheModulusThatTheEyeSees) {
  const Slm slm = make_panel(96, 64);
  const Vec3 eye{0.1e-3, -0.05e-3, 0.02};
  ViewTargets view{-0.03, test_wavelength, slm.grid, Grid{161, 121, 16e-6}, {{eye, 1e-4}}, {Array2D<float>(121, 161)}};
  for (int j = 0; j < 121; ++j)
    for (int i = 0; i < 161; ++i)
      view.amplitudes[0](j, i) = view.picture.y(double(j)) > 0.06e-3 ? 1.0F : view.picture.x(i) < 0.2e-3 ? 0.5F : 0.0F;
  TargetSet targets;
  targets.views = {view};
  targets.eyes = {eye};
  const auto mean_at = [&](const EncodeParams& params, int levels, double x, double y) {
    Hologram hologram = blank_hologram(Field(slm.grid, test_wavelength), slm, params, {});
    write_frame_start(FrameStart::converging, targets, {0, 1}, slm, params, PhaseLevels(slm, levels, test_wavelength),
                      hologram);
    const int column = int(std::lround((x - slm.grid.x(0)) / test_pitch));
    const int row = int(std::lround((slm.grid.y(0.0) - y) / test_pitch));
    std::complex<double> sum = 0;
    for (int j = row; j < row + 4; ++j)
      for (int i = column; i < column + 4; ++i) {
        const double way = length(eye - Vec3{slm.grid.x(i), slm.grid.y(double(j)), 0});
        sum +=
            std::polar(1.0, 2 * pi * (hologram.level(j, i) / double(levels) - (eye.z - way) / test_wavelength)) / 16.0;
      }
    return sum;
  };
  const auto expect = [&](double x, double y, double modulus) {
    const std::complex<double> mean = mean_at(descent(), 256, x, y);
    // Half a level is 0.012 rad. Pairs of a modulus of 0 have the phase 0, so the wave turns a little between them.
    const double error = modulus > 0 ? 0.01 : 0.04;
    EXPECT_NEAR(mean.real(), modulus, error) << x << " " << y;
    EXPECT_NEAR(mean.imag(), 0, error) << x << " " << y;
  };
  expect(0, 0.05e-3, 1);
  expect(0.25e-3, 0.05e-3, 1);
  expect(0, -0.1e-3, 0.5);
  expect(-0.3e-3, -0.05e-3, 0.5);
  expect(0.1e-3, -0.1e-3, 0.5);
  expect(0.2e-3, -0.1e-3, 0);
  // Panels of few levels have no modulus: noise of ±0.35 cycles leaves sin(0.7π)/0.7π = 0.37 of the wave everywhere.
  EncodeParams few = descent();
  few.levels = 4;
  double sum = 0;
  for (int k = 0; k < 20; ++k) sum += mean_at(few, 4, -0.35e-3 + 0.032e-3 * k, -0.1e-3).real() / 20;
  EXPECT_NEAR(sum, 0.37, 0.1);  // 320 pixels of a spread of 0.6: ±0.035
}

// Random phases are not all the same, and those of two frames differ.
TEST(FrameStart, RandomPhasesAreRandom) {
  const Slm slm = make_panel(96, 64);
  const TargetSet targets = one_plane(slm, -lens);
  const auto levels_of = [&](int frame) {
    Hologram hologram = blank_hologram(Field(slm.grid, test_wavelength), slm, descent(), {});
    write_frame_start(FrameStart::random, targets, {frame, 2}, slm, descent(),
                      PhaseLevels(slm, slm.levels, test_wavelength), hologram);
    return hologram.level.values;
  };
  const auto first = levels_of(0);
  const std::set<uint16_t> different(first.begin(), first.end());
  EXPECT_GT(different.size(), 200u);
  EXPECT_NE(first, levels_of(1));
}

}  // namespace
}  // namespace holotrace
