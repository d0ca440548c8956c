#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "holotrace/base/random.h"
#include "holotrace/run/eye_views.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/pupil_picture.h"
#include "support/panels.h"

namespace holotrace {
namespace {

// A panel of 2.0 × 1.5 mm whose light converges to a point 100 mm before it.
Hologram lens_to(const Slm& slm, const Vec3& point) {
  Hologram hologram = make_hologram(slm, Modulation::phase, [](int) { return 0; });
  for (int j = 0; j < slm.grid.ny; ++j)
    for (int i = 0; i < slm.grid.nx; ++i) {
      const double way = length(point - Vec3{slm.grid.x(i), slm.grid.y(double(j)), 0});
      const double turns = (point.z - way) / test_wavelength;
      hologram.level(j, i) = uint16_t(int(std::lround(256 * (turns - std::floor(turns)))) % 256);
    }
  return hologram;
}

// A lens of 256 levels gathers the light of order 0 in a spot of λz/w = 0.03 mm, but for the part sinc²(p·u)·sinc²(p·v) that
// its pixels' aperture takes: u = x/λz at the pixel's place x − x₀.
double light_of_order(const Slm& slm, const Vec3& point) {
  double sum = 0;
  for (int j = 0; j < slm.grid.ny; ++j)
    for (int i = 0; i < slm.grid.nx; ++i) {
      const double u = (point.x - slm.grid.x(i)) / (test_wavelength * point.z);
      const double v = (point.y - slm.grid.y(double(j))) / (test_wavelength * point.z);
      sum += std::pow(sinc(test_pitch * u) * sinc(test_pitch * v), 2);
    }
  return sum / double(slm.grid.pixels());
}

TEST(EyeboxLight, IsWhereALensSendsIt) {
  Job job;
  job.slm = make_panel(256, 192);
  job.wavelengths = {test_wavelength};
  job.encode.method = Encoding::sgd;
  job.encode.eye = {0.2e-3, 0.1e-3, 0.1};
  job.encode.pupil = 1e-3;
  job.encode.eyebox = {"0.6 mm"};
  const Vec3 eye{0.2e-3, 0.1e-3, 0.1};
  const auto light = [&](double x, double y) {
    const Vec3 point = eye + Vec3{x, y, 0};
    const EyeboxLight found = light_of_eyebox(job, eye, {lens_to(job.slm, point)});
    const double all = light_of_order(job.slm, point);
    return std::vector<double>{found.in_box / all, found.in_pupil / all, found.beside / all};
  };
  // The spot's tails beyond 0.5 mm hold 4/π²·0.03/1 = 1 % of its light for each axis.
  const auto expect = [&](double x, double y, double in_box, double in_pupil, double beside) {
    const std::vector<double> found = light(x, y);
    EXPECT_NEAR(found[0], in_box, 0.04) << x << " " << y;
    EXPECT_NEAR(found[1], in_pupil, 0.04) << x << " " << y;
    EXPECT_NEAR(found[2], beside, 0.04) << x << " " << y;
  };
  expect(0, 0, 1, 1, 0);
  expect(0, 0.65e-3, 1, 0, 0);  // in the box of 0.6 mm and half a pupil around it: 0.8 mm from the middle
  expect(0.3e-3, 0, 1, 1, 0);
  expect(1.3e-3, 0, 0, 0, 0.5);  // a pupil at 0.8 + 0.5 mm, right or left
  expect(-1.3e-3, 0.2e-3, 0, 0, 0.5);
  expect(0, -1.0e-3, 0, 0, 0);
}

Job job_for_eye(const Vec3& eye) {
  Job job;
  job.slm = make_panel(256, 192);
  job.wavelengths = {test_wavelength};
  job.encode.method = Encoding::sgd;
  job.encode.target = EncodeTarget::render;
  job.encode.eye = {eye.x, eye.y, eye.z};
  job.encode.pupil = 1e-3;
  job.encode.eyebox = {"0.6 mm"};
  job.camera.distances = {0.05};
  return job;
}

// A hologram that converges to one eye, moved to another one, converges there: it gathers its light in the pupil there as one that was
// made for it does. Levels are rounded twice, by 1/512 of a cycle each.
TEST(MovedToEye, ALensToAnEyeBecomesOneToAnother) {
  const Vec3 from{0.2e-3, 0.1e-3, 0.1}, to{-0.5e-3, 0.4e-3, 0.1};
  Job job = job_for_eye(to);
  const std::vector<Hologram> moved = moved_to_eye({lens_to(job.slm, from)}, {from}, job);
  const Hologram wanted = lens_to(job.slm, to);
  int most = 0;  // levels, around the circle
  for (int j = 0; j < job.slm.grid.ny; ++j)
    for (int i = 0; i < job.slm.grid.nx; ++i) {
      const int apart = (moved.front().level(j, i) - wanted.level(j, i) + 256 + 128) % 256 - 128;
      most = std::max(most, std::abs(apart));
    }
  EXPECT_LE(most, 1);
  EXPECT_GT(light_of_eyebox(job, to, moved).in_pupil, 0.9 * light_of_eyebox(job, to, {wanted}).in_pupil);
  // The same eye, several eyes and holograms for all places stay.
  EXPECT_EQ(moved_to_eye({wanted}, {to}, job).front().level.values, wanted.level.values);
  EXPECT_EQ(moved_to_eye({wanted}, {from, to}, job).front().level.values, wanted.level.values);
  job.encode.target = EncodeTarget::field;
  EXPECT_EQ(moved_to_eye({wanted}, {from}, job).front().level.values, wanted.level.values);
}

// What the eye sees goes with it: of a lens whose phase has a step at x = 0, the step is at Δ = 0.7 mm·50/(50 + 100) = 0.2333 mm to
// the left, 29 pixels.
TEST(MovedToEye, WhatIsSeenThroughThePanelMovesWithTheEye) {
  const Vec3 from{0.2e-3, 0, 0.1}, to{-0.5e-3, 0, 0.1};
  const Job job = job_for_eye(to);
  Hologram stepped = lens_to(job.slm, from);
  for (int j = 0; j < 192; ++j)
    for (int i = 128; i < 256; ++i) stepped.level(j, i) = uint16_t((stepped.level(j, i) + 128) % 256);
  const Hologram moved = moved_to_eye({stepped}, {from}, job).front(), lens = lens_to(job.slm, to);
  for (const int i : {20, 98, 99, 200}) {
    const int turned = ((moved.level(90, i) - lens.level(90, i)) % 256 + 256) % 256;
    EXPECT_NEAR(i < 99 ? (turned + 128) % 256 : turned, 128, 1) << i;
  }
}

// The same of a real image 50 mm before the panel, between it and the eye: Δ = 0.7 mm·50/(100 − 50) = 0.7 mm to the right, 88 pixels
// (87.5, rounded away from 0).
TEST(MovedToEye, WhatFloatsBeforeThePanelMovesTheOtherWay) {
  const Vec3 from{0.2e-3, 0, 0.1}, to{-0.5e-3, 0, 0.1};
  Job job = job_for_eye(to);
  job.encode.image = ImageSide::real_image;
  Hologram stepped = lens_to(job.slm, from);
  for (int j = 0; j < 192; ++j)
    for (int i = 128; i < 256; ++i) stepped.level(j, i) = uint16_t((stepped.level(j, i) + 128) % 256);
  const Hologram moved = moved_to_eye({stepped}, {from}, job).front(), lens = lens_to(job.slm, to);
  for (const int i : {20, 215, 216, 250}) {
    const int turned = ((moved.level(90, i) - lens.level(90, i)) % 256 + 256) % 256;
    EXPECT_NEAR(i < 216 ? (turned + 128) % 256 : turned, 128, 1) << i;
  }
  job.camera.distances = {0.1};  // the image is where the eye is
  EXPECT_EQ(moved_to_eye({stepped}, {from}, job).front().level.values, stepped.level.values);
}

// Of rolling frames a display goes on showing all but the first, whose place the new one takes. Joint holograms and panels of a measured
// response have no phase of one colour.
TEST(MovedToEye, FramesThatAreShownOnStay) {
  const Vec3 from{0.2e-3, 0.1e-3, 0.1}, to{-0.5e-3, 0.4e-3, 0.1};
  Job job = job_for_eye(to);
  std::vector<Hologram> last{lens_to(job.slm, from), lens_to(job.slm, from)};
  last[1].label.frame = 1;
  const auto is_moved = [&](size_t frame) {
    return moved_to_eye(last, {from}, job)[frame].level.values != last[frame].level.values;
  };
  EXPECT_TRUE(is_moved(0));
  EXPECT_TRUE(is_moved(1));
  job.encode.is_rolling = true;
  EXPECT_TRUE(is_moved(0));
  EXPECT_FALSE(is_moved(1));
  job.encode.is_rolling = false;
  last[1].colours.resize(2);
  EXPECT_TRUE(is_moved(0));
  EXPECT_FALSE(is_moved(1));
  for (int level = 0; level < 256; ++level) job.slm.effects.calibration.push_back({level * level / 1e4, 1});
  job.encode.effects = {"calibration"};
  EXPECT_FALSE(is_moved(0));
}

// The light of a box of 0.6 mm ends half a pupil of 1 mm beside it, at 0.8 mm; a pupil outside has its middle at 1.3 mm.
TEST(ViewpointsOf, HaveOneBesideTheEyeboxOfEachEye) {
  Job job;
  job.slm = make_panel(256, 192);
  job.wavelengths = {test_wavelength};
  job.camera.distances = {0.3, 0.2};
  EXPECT_EQ(viewpoints_of(job).size(), 2u);
  job.encode.method = Encoding::sgd;
  job.encode.target = EncodeTarget::render;
  job.encode.eye = {0.2e-3, 0.1e-3, 0.1, -4e-3, 0, 0.2};
  job.encode.pupil = 1e-3;
  job.encode.eyebox = {"0.6 mm"};
  const std::vector<Viewpoint> from = viewpoints_of(job);
  ASSERT_EQ(from.size(), 4u);
  for (const size_t i : {2, 3}) {
    EXPECT_EQ(from[i].kind, ViewKind::beside);
    EXPECT_EQ(from[i].distance, 0.3);
    EXPECT_EQ(from[i].camera.pupil, 1e-3);
  }
  EXPECT_NEAR(from[2].camera.eye.x, 1.5e-3, 1e-15);
  EXPECT_EQ(from[2].camera.eye.y, 0.1e-3);
  EXPECT_EQ(from[2].camera.eye.z, 0.1);
  EXPECT_NEAR(from[3].camera.eye.x, -2.7e-3, 1e-15);
  job.encode.eyebox = {"all"};
  EXPECT_EQ(viewpoints_of(job).size(), 2u);
}

// Two views are blurred together and the third alone, in each wavelength: as one by one, in their order.
TEST(EyeViews, LightOfSeveralWavelengthsIsThatOfEach) {
  LightField light{.panel = {8, 6, 8e-6},
                   .lens = {3, 1, 1e-3},
                   .lens_z = 0.25,
                   .columns = 3,
                   .rows = 1,
                   .plane = {40, 30, 30e-6},
                   .distance = 0.3,
                   .views = {}};
  for (int k = 0; k < 3; ++k) {
    Image& view = light.views.emplace_back(30, 40, 3);
    for (size_t i = 0; i < view.values.size(); ++i) view.values[i] = float(CounterRandom(uint64_t(k), 1, i).uniform());
  }
  const std::vector<double> wavelengths{638e-9, 450e-9};
  std::vector<size_t> taken;
  const std::vector<LightField> both = lights_for_pupil(light, wavelengths, 3e-3, 0.25, [&](size_t k) {
    taken.push_back(k);
    return light.views[k];
  });
  EXPECT_EQ(taken, (std::vector<size_t>{0, 1, 2}));
  ASSERT_EQ(both.size(), 2u);
  for (size_t w = 0; w < 2; ++w)
    for (size_t k = 0; k < 3; ++k) {
      Image alone = seen_at(light.views[k], {wavelengths[w]});
      limit_to_pupil(alone, 30e-6, wavelengths[w], 0.55, 3e-3);
      for (size_t i = 0; i < alone.values.size(); ++i)
        ASSERT_NEAR(both[w].views[k].values[i], alone.values[i], 1e-6) << w << " " << k << " " << i;
    }
}

}  // namespace
}  // namespace holotrace
