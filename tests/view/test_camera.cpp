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

// Largest difference over the largest value of b.
double difference(const Image& a, const Image& b) {
  EXPECT_EQ(a.nx, b.nx);
  EXPECT_EQ(a.ny, b.ny);
  float most = 0, off = 0;
  for (size_t i = 0; i < b.values.size(); ++i) {
    most = std::max(most, b.values[i]);
    off = std::max(off, std::abs(a.values[i] - b.values[i]));
  }
  return off / most;
}

TEST(Camera, ASensorWithThePanelsPixelsSeesTheSame) {
  const Slm slm = make_panel(128, 96);
  CameraParams camera;
  const Image as_panel = look(point_field(slm, 0.02), slm, 0.02, {}, camera);
  camera.pixel = test_pitch;
  camera.binning = 1;
  EXPECT_EQ(look(point_field(slm, 0.02), slm, 0.02, {}, camera).values, as_panel.values);
}

// Against 16 × 16 places. Of a frequency f of the irradiance, places q apart keep sin(πfnq)/(n·sin(πfq)) where the
// pixel's mean keeps sin(πfnq)/(πfnq): too much by (πfq)²/6, with f up to the band's end B = S/λz = 1/104 µm and q up
// to 1/2B. A band that falls off as 1 − f/B leaves √(3·0.41²/105) = 0.07 of the light along an axis, 0.1 along both.
TEST(Camera, APixelTakesAsManyPlacesAsTheLightNeeds) {
  const Slm slm = make_panel(128, 96);
  const Field shown = convert<float>(
      sum_exact({test_wavelength,
                 {{{0.1_mm, 0.05_mm, -0.2}, 1, 0}, {{-0.15_mm, 0, -0.21}, 1, 1}, {{0.02_mm, -0.1_mm, -0.19}, 1, 2}}},
                slm.grid));
  for (const double pixel : {20_um, 50_um, 100_um, 150_um}) {
    CameraParams camera;
    camera.pixel = pixel;
    camera.width = 2.1_mm;
    camera.height = 1.2_mm;
    camera.centre_x = 0.1_mm;
    const Image view = look(shown, slm, 0.2, {}, camera);
    EXPECT_EQ(view.nx, int(std::lround(2.1_mm / pixel)));
    EXPECT_EQ(view.pitch, pixel);
    EXPECT_EQ(view.centre_x, 0.1_mm);
    camera.binning = 16;
    const Image fine = look(shown, slm, 0.2, {}, camera);
    double error = 0, all = 0;
    for (size_t i = 0; i < view.values.size(); ++i) {
      error += std::pow(view.values[i] - fine.values[i], 2);
      all += std::pow(fine.values[i], 2);
    }
    EXPECT_LT(std::sqrt(error / all), 0.1) << pixel;
  }
}

TEST(Camera, ASensorOffTheAxisSeesItsPartOfTheView) {
  const Slm slm = make_panel(96, 96);
  // z* of the whole view is 23 mm: both are the same sums.
  const Field shown = point_field(slm, 0.03);
  CameraParams camera;
  const Image whole = look(shown, slm, 0.03, {}, camera);
  camera.width = camera.height = 40 * test_pitch;
  camera.centre_x = 10 * test_pitch;
  camera.centre_y = -6 * test_pitch;
  const Image part = look(shown, slm, 0.03, {}, camera);
  Image expected(40, 40, 1);
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 40; ++i) expected(j, i) = whole(28 + 6 + j, 28 + 10 + i);
  EXPECT_LT(difference(part, expected), 1e-5);  // float transforms of other lengths
  camera.pixel = test_pitch;
  camera.binning = 1;
  EXPECT_EQ(look(shown, slm, 0.03, {}, camera).values, part.values);
}

TEST(Camera, ARenderIsSeenWhereTheSensorIs) {
  Image render(60, 60, 1), sensor(30, 30, 1);
  for (int j = 0; j < 60; ++j)
    for (int i = 0; i < 60; ++i) render(j, i) = float(std::sin(0.2 * i) + 0.1 * j);
  sensor.pitch = 2 * 0.01 / 60 * 0.3;  // a pixel of the render at 0.3 m
  sensor.centre_x = 5 * sensor.pitch;
  sensor.centre_y = -3 * sensor.pitch;
  const Image seen = project_render(render, 0.01, sensor, 0.3);
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 30; ++i) ASSERT_NEAR(seen(j, i), render(j + 15 + 3, i + 15 + 5), 1e-5);  // 1e-12 of a pixel
}

TEST(Camera, ASensorThatCannotBeIsRefused) {
  const Slm slm = make_panel(64, 64);
  const Field shown = point_field(slm, 0.02);
  CameraParams camera;
  camera.pixel = -1_um;
  EXPECT_THROW(look(shown, slm, 0.02, {}, camera), Error);
  camera.pixel = 10_mm;  // wider than the panel
  EXPECT_THROW(look(shown, slm, 0.02, {}, camera), Error);
  camera.pixel = 8_um;
  PropagateParams window;
  window.pitch = 4_um;
  EXPECT_THROW(look(shown, slm, 0.02, window, camera), Error);
}

}  // namespace
}  // namespace holotrace
