#include <gtest/gtest.h>

#include "holotrace/base/error.h"
#include "holotrace/view/camera.h"
#include "holotrace/wave/sum_exact.h"
#include "support/panels.h"

namespace holotrace {
namespace {

using namespace literals;

// A point of that depth on the axis, as the panel shows it.
Field point_field(const Slm& slm, double depth) {
  return convert<float>(sum_exact({test_wavelength, {{{0, 0, -depth}, 1, 0}}}, slm.grid));
}

// Where the light of a view lies in x [m].
double centroid(const Image& view) {
  double moment = 0, sum = 0;
  for (int j = 0; j < view.ny; ++j)
    for (int i = 0; i < view.nx; ++i) {
      moment += view(j, i) * (i - (view.nx - 1) / 2.0) * view.pitch;
      sum += view(j, i);
    }
  return moment / sum;
}

TEST(Camera, AnEyeSeesPointsBehindAndBeforeItsFocusShiftedByParallax) {
  Slm slm = make_panel(256, 192);
  for (const double z : {0.0, 0.03})
    for (const double depth : {0.06, 0.04}) {
      CameraParams camera;
      camera.pupil = 0.6_mm;
      camera.eye = {0.4_mm, 0, z};
      const Image view = look(point_field(slm, depth), slm, 0.05, {}, camera);
      // The ray from (0, −depth) through the middle of the pupil, in the plane z = −50 mm. The disc of blur is even
      // about it, its diffraction rings too: within half a pixel.
      const double expected = camera.eye.x * (depth - 0.05) / (depth + z);
      EXPECT_NEAR(centroid(view), expected, test_pitch / 2) << "depth " << depth << " eye at z " << z;
    }
}

TEST(Camera, APupilAroundThePanelLetsAllLightThrough) {
  const Slm slm = make_panel(128, 96);
  CameraParams camera;
  const Image whole = look(point_field(slm, 0.05), slm, 0.05, {}, camera);
  camera.pupil = 10_mm;
  EXPECT_EQ(look(point_field(slm, 0.05), slm, 0.05, {}, camera).values, whole.values);
}

TEST(Camera, AnEyeBehindThePanelOrBesideItIsRefused) {
  const Slm slm = make_panel(128, 96);
  CameraParams camera;
  camera.pupil = 0.2_mm;
  camera.eye = {0, 0, -1_mm};
  EXPECT_THROW(look(point_field(slm, 0.05), slm, 0.05, {}, camera), Error);
  camera.eye = {5_mm, 0, 0};
  EXPECT_THROW(look(point_field(slm, 0.05), slm, 0.05, {}, camera), Error);
}

}  // namespace
}  // namespace holotrace
