#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "holotrace/slm/encode/iterate/processor_arrays.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "support/descent.h"

// The gradient of gradient_descent.h, as support/descent.h puts it together, against differences of its loss.

namespace holotrace {
namespace {

// The squares of slopes, added up, and the steepest one.
struct Steepness {
  double square = 0, most = 0;

  void add(const Array2D<float>& slopes) {
    for (const float d : slopes.values) {
      square += double(d) * d;
      most = std::max(most, std::abs(double(d)));
    }
  }
};

struct GradientCase {
  std::string name;
  Slm slm;
  EncodeParams params{};
  Modulation modulation = Modulation::phase;
  std::vector<double> planes{-0.004};
  std::vector<Pupil> pupils{};  // of further targets, behind the panel as the first
  bool has_two_colours = false;
  PanelDetail detail{};
};

Slm uneven_panel(Slm slm) {
  slm.effects.crosstalk = 0.25;
  slm.effects.gap_amplitude = 0.5;
  slm.effects.aberration = {{2, 0, 0.4}};
  return slm;
}

PanelDetail detail_of(PixelDetail detail) { return {.light = detail, .slopes = detail}; }

std::vector<GradientCase> gradient_cases() {
  const Slm plain = make_panel(64, 40, 256, 0.9);
  Slm uneven = plain, amplitude = plain, calibrated = plain, complex = uneven_panel(plain);
  uneven = uneven_panel(plain);
  complex.modulation = Modulation::complex;
  amplitude.modulation = Modulation::amplitude;
  for (int level = 0; level < 256; ++level)
    calibrated.effects.calibration.push_back({2 * pi * level / 256.0 * (0.9 + level / 2560.0), 1 - level / 1024.0});
  Slm complex_calibrated = complex;
  complex_calibrated.effects = calibrated.effects;
  const EncodeParams stop{.stop = 0.5}, finer{.subpixels = 3}, both{.stop = 0.5, .subpixels = 3};
  const std::vector<Pupil> pupils{{{0, 0, 0.004}, 1.7e-4}, {{6e-5, -5e-5, 0.006}, 2.3e-4}};
  return {{"plain", plain},
          {"planes", plain, {}, Modulation::phase, {-0.004, 0.003, -0.0045}},
          {"colours", plain, {}, Modulation::phase, {-0.004}, {}, true},
          {"effects", uneven},
          {.name = "effects, coarse", .slm = uneven, .params = {}, .detail = detail_of(PixelDetail::coarse)},
          {.name = "effects, mean", .slm = uneven, .params = {}, .detail = detail_of(PixelDetail::mean)},
          {"effects, colours", uneven, {}, Modulation::phase, {-0.004}, {}, true},
          {"calibration", calibrated},
          {"stop", plain, stop},
          {"subpixels", plain, finer},
          {"subpixels, effects, stop", uneven, both},
          {"pupils", plain, {}, Modulation::phase, {-0.004}},
          {"pupils, effects, stop", uneven, stop, Modulation::phase, {-0.004}},
          {"pupils, subpixels", plain, finer, Modulation::phase, {-0.004}},
          {"complex, effects", complex, stop, Modulation::complex, {-0.004}},
          {.name = "complex, mean",
           .slm = complex,
           .params = finer,
           .modulation = Modulation::complex,
           .detail = detail_of(PixelDetail::mean)},
          {"complex, calibration", complex_calibrated, finer, Modulation::complex},
          {"amplitude", amplitude, {}, Modulation::amplitude},
          {"amplitude, effects", uneven, finer, Modulation::amplitude, {-0.004}}};
}

TEST(Gradient, IsThatOfFiniteDifferences) {
  // Central differences along the gradient: the error is of third order in the step; 1 % covers it and the floats.
  for (const GradientCase& c : gradient_cases())
    for (const int frames : {1, 3}) {
      const EncodeParams picture{.target_distances = {0.004}, .target_columns = 40, .target_rows = 24};
      TargetPlane target = picture_targets(c.slm, picture).front();
      std::vector<TargetPlane> targets;
      for (const double z : c.planes) {
        target.z = z;
        targets.push_back(target);
      }
      if (c.has_two_colours) targets.push_back(picture_targets(c.slm, picture, 633e-9).front());
      const Descent descent{targets, c.slm, c.params, make_hologram(c.slm, c.modulation, [](int) { return 0; }),
                            c.detail};
      std::vector<Drive> drives, slopes;
      CounterRandom random(5, 0, 0);
      for (int m = 0; m < frames; ++m) {
        const bool has_modulus = c.modulation == Modulation::complex;
        drives.push_back({Array2D<float>(40, 64), has_modulus ? Array2D<float>(40, 64) : Array2D<float>()});
        each_array(drives.back(), [&](Array2D<float>& values) {
          for (float& level : values.values) level = float(20.3 + 200 * random.uniform());
        });
      }
      descent.loss(drives, &slopes);
      Steepness steepness;
      for (Drive& slope : slopes) each_array(slope, [&](const Array2D<float>& values) { steepness.add(values); });
      const auto [square, most] = steepness;
      const double h = 2 / most;  // the largest change is 2 levels, 0.05 rad
      const auto at = [&](double step) {
        std::vector<Drive> moved = drives;
        for (size_t m = 0; m < moved.size(); ++m)
          for (Array2D<float> Drive::*values : {&Drive::level, &Drive::modulus})
            for (size_t i = 0; i < (moved[m].*values).size(); ++i)
              (moved[m].*values).values[i] += float(step * double((slopes[m].*values).values[i]));
        return descent.loss(moved, nullptr);
      };
      EXPECT_NEAR((at(h) - at(-h)) / (2 * h) / square, 1, 0.01) << c.name << ", frames: " << frames;
    }
}

// Crosstalk of 0.25 pixels: for random phases on [0, 2π) coarse light differs by 0.05 of its modulus (−26 dB, computed in
// double with another program). Slopes of the mean leave out what differs within a pixel. They are not the exact ones, but nearly
// in their direction: 45° would lose half of a step.
TEST(DrivenPanel, IsNearlyTheSameWithLessDetail) {
  const Slm slm = uneven_panel(make_panel(64, 40, 256, 0.9));
  const DrivenPanel panel(slm, make_hologram(slm, Modulation::phase, [](int) { return 0; }), test_wavelength);
  EXPECT_TRUE(panel.has_crosstalk());
  EXPECT_FALSE(
      DrivenPanel(make_panel(64, 40), make_hologram(slm, Modulation::phase, [](int) { return 0; }), test_wavelength)
          .has_crosstalk());
  Drive drive{Array2D<float>(40, 64), {}};
  CounterRandom random(5, 0, 0);
  for (float& level : drive.level.values) level = float(256 * random.uniform());
  Field fine, coarse;
  panel.leave(drive, fine);
  panel.leave(drive, coarse, {.light = PixelDetail::coarse});
  double square = 0, change = 0;
  for (size_t i = 0; i < fine.samples.size(); ++i) {
    square += std::norm(fine.samples.values[i]);
    change += std::norm(fine.samples.values[i] - coarse.samples.values[i]);
  }
  EXPECT_GT(std::sqrt(change / square), 0.02);
  EXPECT_LT(std::sqrt(change / square), 0.08);

  const Field g = random_field(fine.grid, 2);
  Drive exact = Drive::like(drive), of_mean = exact;
  panel.add_slope(drive, fine, g, 1, exact);
  panel.add_slope(drive, fine, g, 1, of_mean, {.slopes = PixelDetail::mean});
  const auto product = [](const Drive& a, const Drive& b) {
    return std::inner_product(a.level.values.begin(), a.level.values.end(), b.level.values.begin(), 0.0);
  };
  const double cosine = product(exact, of_mean) / std::sqrt(product(exact, exact) * product(of_mean, of_mean));
  EXPECT_GT(cosine, std::sqrt(0.5));
  EXPECT_LT(cosine, 0.999);
}

// Of two levels, 0 and π, the light of a pixel can only jump by Δu = u₁ − u₀ along a straight line. Halfway on the circle
// the light moves along that line, π/2 times as fast as on it: slope = π/2·Re⟨g, Δu⟩, whatever the level is.
TEST(Gradient, OfTwoLevelsIsThatAlongTheLineBetweenThem) {
  Slm with_gaps = make_panel(48, 32, 2, 0.9);
  with_gaps.effects.gap_amplitude = 0.5;
  with_gaps.effects.aberration = {{2, 0, 0.4}};
  for (const Slm& slm : {make_panel(48, 32, 2), with_gaps})
    for (const int subpixels : {1, 3}) {
      const DrivenPanel panel(slm, make_hologram(slm, Modulation::phase, [](int) { return 0; }), test_wavelength,
                              subpixels);
      const Grid grid{48 * subpixels, 32 * subpixels, test_pitch / subpixels};
      Drive drive{Array2D<float>(32, 48), {}}, slope = Drive::like(drive);
      CounterRandom random(5, 0, 0);
      for (float& level : drive.level.values) level = float(random.uniform() < 0.5);
      Field u(grid, test_wavelength), flipped(grid, test_wavelength);
      const Field g = random_field(grid, 2);
      panel.leave(drive, u);
      panel.add_slope(drive, u, g, 1, slope);
      Drive other = drive;  // some pixels show the other level
      double expected = 0, square = 0;
      for (size_t i = 0; i < other.level.size(); ++i) {
        square += double(slope.level.values[i]) * slope.level.values[i];
        if (random.uniform() < 0.7) continue;
        other.level.values[i] = 1 - drive.level.values[i];
        expected += double(other.level.values[i] - drive.level.values[i]) * slope.level.values[i];
      }
      panel.leave(other, flipped);
      const double change = inner(g, flipped).real() - inner(g, u).real();
      EXPECT_NEAR(pi / 2 * change, expected, 1e-4 * std::sqrt(square)) << subpixels;  // float sums
      EXPECT_GT(std::abs(expected), std::sqrt(square) / 100) << subpixels;            // else it proves nothing
    }
}

// The error of views through a pupil beside the axis, in a window of its own: Σ(s·A − a)² at a fixed scale.
TEST(Gradient, OfViewsIsThatOfFiniteDifferences) {
  const Slm slm = make_panel(48, 36, 65536);  // levels so fine that rounding is negligible
  constexpr double scale = 1.3;
  EncodeParams params;
  params.method = Encoding::sgd;
  for (const Pupil& pupil : {Pupil{{1e-4, -5e-5, 0.02}, 1.7e-4}, Pupil{{-9e-5, 6e-5, 0.03}, 2.3e-4}}) {
    const double radius = pupil.diameter / 2;
    const PlanePart part{{pupil.centre.x - radius, pupil.centre.y - radius},
                         {pupil.centre.x + radius, pupil.centre.y + radius}};
    ViewTargets views;
    views.z = -0.01;
    views.wavelength = test_wavelength;
    views.window = pupil_window_grid(slm.grid, part);
    views.picture = picture_grid(slm.grid, slm.grid.width(), slm.grid.height(), pupil, test_wavelength, views.z);
    views.pupils = {pupil};
    CounterRandom random(8, 0, 0);
    views.amplitudes.emplace_back(views.picture.ny, views.picture.nx);
    for (float& a : views.amplitudes.back().values) a = float(random.uniform());
    std::vector<Hologram> frames(2, make_hologram(slm, Modulation::phase, [](int) { return 0; }));
    for (Hologram& frame : frames)
      for (uint16_t& level : frame.level.values) level = uint16_t(20000 + 20000 * random.uniform());
    const DrivenPanel panel(slm, frames.front(), test_wavelength);
    const auto error_of = [&](const std::vector<Hologram>& shown) {
      ProcessorFrames arrays(slm, params, shown);
      const auto light = arrays.light_of(panel, test_wavelength);
      light->leave({});
      const ModulusSums sums = light->view_sums(views, false);
      return target_power(views) - 2 * scale * sums.cross + scale * scale * sums.square;
    };
    ProcessorFrames arrays(slm, params, frames);
    const auto light = arrays.light_of(panel, test_wavelength);
    arrays.clear_slopes();
    light->leave({});
    light->view_sums(views, true);
    EXPECT_NEAR(light->add_gradient_of_views(views, scale, 1), error_of(frames), 1e-5 * error_of(frames));  // floats
    const AdamStep mean_is_slope{0, 0, 0, 1};
    arrays.step({mean_is_slope, mean_is_slope, 0, 65536, 1});
    const std::vector<Array2D<float>> state = arrays.state();  // of each frame: rounded, drive, mean, square
    Steepness steepness;
    for (const size_t mean : {size_t(2), size_t(6)}) steepness.add(state[mean]);
    const auto [square, most] = steepness;
    const double h = 500 / most;  // the largest change is 500 levels, 0.05 rad
    const auto at = [&](double step) {
      std::vector<Hologram> moved = frames;
      for (size_t m = 0; m < moved.size(); ++m)
        for (size_t i = 0; i < moved[m].level.size(); ++i)
          moved[m].level.values[i] =
              uint16_t(std::lround(moved[m].level.values[i] + step * double(state[4 * m + 2].values[i])));
      return error_of(moved);
    };
    EXPECT_NEAR((at(h) - at(-h)) / (2 * h) / square, 1, 0.01);  // third order in the step, and rounding
  }
}

}  // namespace
}  // namespace holotrace
