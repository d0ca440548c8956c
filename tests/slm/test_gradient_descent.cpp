#include <tbb/global_control.h>

#include <cmath>

#include "holotrace/slm/driven_panel.h"
#include "holotrace/slm/gradient_descent.h"
#include "holotrace/slm/plane_sums.h"
#include "support/targets.h"

namespace holotrace {
namespace {

// f(ℓ) of gradient_descent.h without rounding, and its gradient if there is room for it.
double loss(const std::vector<TargetPlane>& targets, const Slm& slm, const Hologram& hologram,
            const Array2D<float>& drive, Array2D<float>* slope) {
  double sum = 0;
  for (const TargetPlane& target : targets) {  // each of a wavelength of its own
    const DrivenPanel panel(slm, hologram, target.wavelength);
    const PlaneOptics optics = make_plane_optics(slm, target.wavelength, target.z, panel.aperture());
    Field u(slm.grid, target.wavelength);
    panel.leave(drive, u);
    Field shown = optics.to_plane(u);
    const ModulusSums sums = fit_sums(target, shown);
    const double s = sums.cross / sums.square;
    sum += s * s * leave_residual(target, 1 / s, shown);
    if (slope) panel.add_slope(drive, u, optics.to_panel(shown), -2 * s * s, *slope);
  }
  return sum;
}

TEST(GradientDescent, GradientIsThatOfFiniteDifferences) {
  // Along the gradient itself, central differences: of third order in the step, so that 1 % holds them and the floats.
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
  // Both at once are harder than one, and far better than the one's hologram is for the other colour.
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
  const Hologram of_one = encode_targets({targets[0]}, start, slm, params);
  Hologram again = of_one;
  judge(targets, slm, alone.observer(), again);
  EXPECT_GT(joint.number("psnr_db"), alone.number("psnr_db") + 3);  // half the error's power at least
}

}  // namespace
}  // namespace holotrace
