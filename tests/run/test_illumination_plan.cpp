// How many states partly coherent light needs.

#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/run/illumination_plan.h"
#include "support/error_of.h"

namespace holotrace::test {
namespace {

// A spectrum of Δλ = 50 nm moves the light of a plane at z = 1 m by up to sinθ·z·Δλ/λ, with sinθ = W/z of a panel of the
// width W, less than its λ/2p. There is a state for every half of what a pupil of 0.5 mm resolves, λ·d/D. The pupil at
// 1.1 m is d = 0.1 m from a real image, in front of the panel, and 2.1 m from a virtual one: 28 states, and 2, fewer than
// the least number of 8.
TEST(IlluminationPlan, CountsFromTheImageToThePupil) {
  constexpr double wavelength = 532e-9, pitch = 8e-6, bandwidth = 50e-9, pupil = 0.5e-3;
  Slm slm;
  slm.grid = {1920, 1080, pitch};
  ShowParams show;
  show.bandwidth = bandwidth;
  CameraParams camera;
  camera.pupil = pupil;
  camera.eye = {0, 0, 1.1};
  const Viewpoint from{ViewKind::distance, "look", 1.0, 0, camera};
  const double moved = slm.grid.width() * bandwidth / wavelength, half = wavelength * 0.1 / pupil / 2;
  ASSERT_EQ(std::ceil(moved / half), 28);
  EXPECT_EQ(plan_illumination(slm, show, wavelength, ImageSide::real_image, {from}, {}).needed, 28);
  EXPECT_EQ(plan_illumination(slm, show, wavelength, ImageSide::virtual_image, {from}, {}).needed, 8);
}

// A source of 0.01 rad moves the light by a tenth of a pupil of 1 mm at 10 mm: π/4·0.8² states, and by all of it at 100 mm.
// An eye beside the eyebox there changes nothing for the others.
TEST(IlluminationPlan, OfAnEyeBesideTheEyeboxIsThatOfTheOthers) {
  Slm slm;
  slm.grid = {1920, 1080, 8e-6};
  ShowParams show;
  show.source_angle = 0.01;
  show.bandwidth = 10e-9;
  CameraParams camera;
  camera.pupil = 1e-3;
  camera.eye = {0, 0, 0.01};
  const Viewpoint from{ViewKind::distance, "look", 1.0, 0, camera};
  camera.eye.z = 0.1;
  const Viewpoint far{ViewKind::distance, "look", 1.0, 0, camera}, beside{ViewKind::beside, "beside", 1.0, 0, camera};
  const auto needed = [&](const std::vector<Viewpoint>& views) {
    return plan_illumination(slm, show, 532e-9, ImageSide::virtual_image, views, {}).needed;
  };
  EXPECT_EQ(needed({from, beside}), needed({from}));
  EXPECT_GT(needed({from, far}), needed({from}));
}

// A pixel of 8 µm holds light of 532 nm up to asin(λ/2p) = 1.9°. The source's middle is within, its edge at 15° is not: that
// is said before the first of many states is shown.
TEST(IlluminationPlan, RefusesAStateThatThePixelsCannotHold) {
  Slm slm;
  slm.grid = {64, 48, 8e-6};
  ShowParams show;
  show.source_angle = 30 * pi / 180;
  show.illumination_states = 16;
  const Viewpoint from{ViewKind::distance, "look", 0.1, 0, {}};
  const auto plan = [&] { plan_illumination(slm, show, 532e-9, ImageSide::virtual_image, {from}, {}); };
  EXPECT_NE(error_of(plan).find("expected illumination at an angle below 1.905"), std::string::npos) << error_of(plan);
  show.source_angle = 1 * pi / 180;
  EXPECT_NO_THROW(plan());
}

}  // namespace
}  // namespace holotrace::test
