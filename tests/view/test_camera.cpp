#include <gtest/gtest.h>

#include "holotrace/base/error.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/sum_exact.h"
#include "support/panels.h"

namespace holotrace {
namespace {

using namespace literals;

// A point of that depth on the axis, as the panel shows it.
Field point_field(const Slm& slm, double depth) {
  return convert<float>(sum_exact({test_wavelength, {{{0, 0, -depth}, 1, 0}}}, slm.grid));
}

// Centroid of the light of a view in x [m].
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
      // about it, and so are its diffraction rings: to half a pixel.
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

// Largest difference relative to the largest value of b.
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

// Compared with 16 × 16 places. mean_over_pixels states 0.7 % of the mean for light whose band ends at what the samples
// represent, and less for more samples.
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
    EXPECT_LT(std::sqrt(error / all), 0.01) << pixel;
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
  EXPECT_LT(difference(part, expected), 1e-5);  // float transforms of different lengths
  camera.pixel = test_pitch;
  camera.binning = 1;
  EXPECT_EQ(look(shown, slm, 0.03, {}, camera).values, part.values);
}

// By similar triangles the line from the eye through the panel's centre meets the plane at the distance d at −e·d/e_z; of the
// real image, which is before the panel, at e·d/e_z.
TEST(Camera, TheWindowOfAnEyeIsWhatItSeesThroughThePanelsMiddle) {
  const Slm slm = make_panel(128, 96);
  CameraParams camera;
  camera.pupil = 0.4_mm;
  camera.eye = {0.6_mm, -0.3_mm, 40_mm};
  for (const ImageSide image : {ImageSide::virtual_image, ImageSide::real_image})
    for (const double distance : {20_mm, -20_mm}) {
      Field shown = point_field(slm, 0.02);
      shown.image = image;
      const double side = (image == ImageSide::virtual_image ? -1 : 1) * (distance > 0 ? 1 : -1);
      CameraParams by_hand = camera;
      by_hand.centre_x = side * 0.3_mm + 2 * test_pitch;
      by_hand.centre_y = -side * 0.15_mm;
      CameraParams follows = camera;
      follows.window = ViewWindow::eye;
      follows.centre_x = 2 * test_pitch;  // is counted from there
      const Image seen = look(shown, slm, distance, {}, follows), expected = look(shown, slm, distance, {}, by_hand);
      EXPECT_NEAR(seen.centre_x, by_hand.centre_x, 1e-15);  // rounding
      EXPECT_NEAR(seen.centre_y, by_hand.centre_y, 1e-15);
      EXPECT_LT(difference(seen, expected), 1e-5);  // float transforms of a window that moved by 1e-19 m
    }
}

// Without a pupil, or with an eye on the panel, there is nothing to follow.
TEST(Camera, AWindowFollowsAnEyeWithAPupilBeforeThePanel) {
  CameraParams camera{.window = ViewWindow::eye};
  camera.eye = {1_mm, 0, 0.1};
  EXPECT_EQ(middle_of_window(camera, 0.3, ImageSide::virtual_image).x, 0);
  camera.pupil = 2_mm;
  EXPECT_EQ(middle_of_window(camera, 0.3, ImageSide::virtual_image).x, -0.01);
  EXPECT_EQ(camera_in(viewing_conditions(camera)).window, ViewWindow::eye);  // as files of holograms have it
  camera.eye.z = 0;
  EXPECT_EQ(middle_of_window(camera, 0.3, ImageSide::virtual_image).x, 0);
  camera.eye.z = 0.1;
  for (const ViewWindow window : {ViewWindow::axis, ViewWindow::automatic}) {
    camera.window = window;
    EXPECT_EQ(middle_of_window(camera, 0.3, ImageSide::virtual_image).x, 0);
  }
}

TEST(Camera, ARenderIsSeenWhereTheSensorIs) {
  Image render(60, 60, 1), sensor(30, 30, 1);
  for (int j = 0; j < 60; ++j)
    for (int i = 0; i < 60; ++i) render(j, i) = float(std::sin(0.2 * i) + 0.1 * j);
  sensor.pitch = 2 * 0.01 / 60 * 0.3;  // twice a pixel of the render at 0.3 m
  sensor.centre_x = 5 * sensor.pitch;
  sensor.centre_y = -3 * sensor.pitch;
  const Image seen = project_render(render, 0.01, sensor, 0.3);
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 30; ++i) ASSERT_NEAR(seen(j, i), render(j + 15 + 3, i + 15 + 5), 1e-5);  // 1e-12 of a pixel
}

// The outer half of an outer pixel has no neighbour to interpolate with, but light.
TEST(ProjectRender, KeepsTheOuterPixels) {
  Image render(4, 6, 1);
  for (size_t i = 0; i < render.values.size(); ++i) render.values[i] = float(i + 1);
  Image sensor(4, 6, 1);
  sensor.pitch = 2 * 0.01 / 4 * 0.3;  // the same pixels at 0.3 m
  const Image seen = project_render(render, 0.01, sensor, 0.3);
  for (size_t i = 0; i < render.values.size(); ++i)
    EXPECT_NEAR(seen.values[i], render.values[i], 1e-6 * render.values[i]) << i;  // floats
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

// A thin lens step by step: propagation to its plane, its pupil and phase, propagation to the plane of its sensor. The
// picture there is upside down, about the lens's own axis.
Image true_lens(const Field& shown, const CameraParams& camera, double distance, int pixels, double pixel) {
  const double s = camera.eye.z + distance, f = camera.focal_length, to_sensor = s * f / (s - f);
  FieldDouble in_lens = propagate(convert<double>(shown), camera.eye.z);
  for (int j = 0; j < in_lens.grid.ny; ++j)
    for (int i = 0; i < in_lens.grid.nx; ++i) {
      const double r = std::hypot(in_lens.grid.x(i) - camera.eye.x, in_lens.grid.y(j) - camera.eye.y);
      const double phase = -pi * r * r / (shown.wavelength * f);
      in_lens.samples(j, i) *= r <= camera.pupil / 2 ? std::polar(1.0, phase) : 0.0;
    }
  PropagateParams sensor;
  sensor.columns = sensor.rows = pixels;
  sensor.pitch = pixel;
  sensor.centre_x = camera.eye.x * (1 + to_sensor / s);
  sensor.centre_y = camera.eye.y * (1 + to_sensor / s);
  const FieldDouble at_sensor = propagate(in_lens, to_sensor, sensor);
  Image upright(pixels, pixels, 1);
  for (int j = 0; j < pixels; ++j)
    for (int i = 0; i < pixels; ++i)
      upright(pixels - 1 - j, pixels - 1 - i) = float(std::norm(at_sensor.samples(j, i)));
  return upright;
}

double relative_difference(const Image& a, const Image& b) {
  double error = 0, all = 0;
  for (size_t i = 0; i < b.values.size(); ++i) {
    error += std::pow(double(a.values[i]) - double(b.values[i]), 2);
    all += std::pow(double(b.values[i]), 2);
  }
  return std::sqrt(error / all);
}

// A lens of 20 mm, 20 mm in front of the panel. Its sphere differs from a parabola by k·r⁴/8·(1/s³ + 1/s'³) = 5e-4 rad
// at the pupil's rim, and its cosines from 1 by (0.3/20)²/2 = 1e-4.
TEST(Camera, AThinLensMakesTheImageThatItsPhaseAndItsPupilMake) {
  const Slm slm = make_panel(192, 192);
  const Field shown = convert<float>(sum_exact(
      {test_wavelength,
       {{{0.1_mm, 0.05_mm, -0.04}, 1, 0}, {{-0.15_mm, 0.2_mm, -0.05}, 1, 1}, {{0.02_mm, -0.1_mm, -0.03}, 1, 2}}},
      slm.grid));
  CameraParams camera;
  camera.pupil = 0.6_mm;
  camera.focal_length = 20_mm;
  camera.pixel = 4_um;
  camera.sampling = PixelSampling::point;
  camera.width = camera.height = 128 * 4_um;
  for (const double distance : {0.03, 0.04, 0.05})
    for (const Vec3 eye : {Vec3{0, 0, 0.02}, Vec3{0.1_mm, -0.15_mm, 0.02}}) {
      camera.eye = eye;
      const Image view = look(shown, slm, distance, {}, camera);
      ASSERT_EQ(view.nx, 128);
      EXPECT_NEAR(view.pitch, 4_um, 1e-18);
      const Image expected = true_lens(shown, camera, distance, 128, 4_um);
      EXPECT_LT(relative_difference(view, expected), 5e-3) << distance << " " << eye.x;
    }
}

TEST(Camera, ALensMagnifiesByItsFormulaAndKeepsTheLight) {
  const Slm slm = make_panel(192, 192);
  const Field shown = convert<float>(sum_exact({test_wavelength, {{{0.2_mm, 0, -0.04}, 1, 0}}}, slm.grid));
  CameraParams camera;
  camera.pupil = 0.6_mm;
  camera.eye.z = 20_mm;
  const Image plane = look(shown, slm, 0.04, {}, camera);
  double light = 0, with_lens = 0;
  for (const float v : plane.values) light += double(v) * plane.pitch * plane.pitch;
  for (const double f : {5_mm, 10_mm, 14_mm}) {
    camera.focal_length = f;
    const double m = f / (0.06 - f);
    EXPECT_DOUBLE_EQ(magnification(camera, 0.04, ImageSide::virtual_image), m);
    EXPECT_DOUBLE_EQ(magnification(camera, 0.005, ImageSide::real_image), f / (0.015 - f)) << "s = 20 − 5 mm";
    const Image view = look(shown, slm, 0.04, {}, camera);
    EXPECT_NEAR(centroid(view), m * 0.2_mm, 0.01 * m * 0.2_mm);  // Airy's tails extend past one side of the window
    with_lens = 0;
    for (const float v : view.values) with_lens += double(v) * view.pitch * view.pitch;
    EXPECT_NEAR(with_lens / light, 1, 1e-5);  // floats
  }
}

// First zero of Airy's pattern, 1.2197·λ·s'/D, s' the distance of the sensor (closed_forms.md: test value 8).
TEST(Camera, APointInFocusIsAirysDisc) {
  const Slm slm = make_panel(256, 256);
  CameraParams camera;
  camera.pupil = 0.6_mm;
  camera.eye.z = 20_mm;
  camera.focal_length = 20_mm;
  camera.pixel = 1_um;
  camera.binning = 1;
  camera.width = camera.height = 129_um;
  const Image view = look(point_field(slm, 0.04), slm, 0.04, {}, camera);
  int first = 64;
  while (first + 1 < 129 && view(64, first + 1) < view(64, first)) ++first;
  const double radius = 1.2196699 * test_wavelength * 30_mm / camera.pupil;  // 32.4 µm
  EXPECT_NEAR((first - 64) * 1_um, radius, 1_um);                            // a pixel
  EXPECT_LT(view(64, first), 2e-3 * view(64, 64));                           // within half a pixel of the zero
}

// A point at d is blurred to a disc of diameter D·|d − distance|/(d + z) in the plane in focus, m times that on the
// sensor.
// Half of an even disc's light is within its radius over √2. The shadow of N = (D/2)²·(1/30 mm − 1/60 mm)/λ = 18 zones
// has N/2 rings, so the light within a circle varies by about 1/2N.
TEST(Camera, APointOutOfFocusBlursToThePupilsShadow) {
  const Slm slm = make_panel(256, 256);
  CameraParams camera;
  camera.pupil = 1.5_mm;
  camera.eye.z = 20_mm;
  camera.focal_length = 20_mm;
  camera.pixel = 8_um;
  camera.width = camera.height = 3.2_mm;
  const Image view = look(point_field(slm, 0.04), slm, 0.01, {}, camera);
  const double radius = 2 * camera.pupil / 2 * (0.04 - 0.01) / 0.06;
  double inside = 0, all = 0;
  for (int j = 0; j < view.ny; ++j)
    for (int i = 0; i < view.nx; ++i) {
      const double r = std::hypot(i - (view.nx - 1) / 2.0, j - (view.ny - 1) / 2.0) * view.pitch;
      all += view(j, i);
      inside += r <= radius / std::sqrt(2) ? view(j, i) : 0;
    }
  EXPECT_NEAR(inside / all, 0.5, 0.03);
}

TEST(Camera, LensesThatCannotImageAreRefused) {
  const Slm slm = make_panel(64, 64);
  const Field shown = point_field(slm, 0.02);
  CameraParams camera;
  camera.focal_length = 50_mm;
  EXPECT_EQ(error_of([&] { look(shown, slm, 0.02, {}, camera); }),
            "expected a pupil above 0 m for a lens of 50 mm, got 0 m; give its diameter");
  camera.pupil = 0.2_mm;
  camera.eye.z = 30_mm;
  EXPECT_EQ(error_of([&] { look(shown, slm, 0.02, {}, camera); }),
            "expected a plane farther from the lens than its focal length of 50 mm, got one at 50 mm; move the "
            "eye back, or use a shorter focal length");
  camera.focal_length = -1_mm;
  EXPECT_EQ(error_of([&] { look(shown, slm, 0.02, {}, camera); }),
            "expected a length of 0 m or more for \"focal_length\", got -1 mm");
}

// A flat panel sends order (1, 0) to z·λ/p = 6.65 mm, with F²·sinc²(√F) of its light. A pupil of 3 mm receives a whole
// beam of 2 mm except for the light that its edges spread, λz/(π²·2 mm)·2/0.5 mm = 1 % along each axis. Of order 0,
// 0.757 of the light, it receives what edges spread from 5.15 to 8.15 mm: 1.9e-4 of it, 3.7 % of the expected light.
TEST(Camera, APupilBetweenSamplesIsToldToGrowAndOneBesideThePanelToMove) {
  // On a panel of even sides the nearest samples are 4√2 = 5.7 µm off the axis.
  const Slm slm = make_panel(64, 64);
  Field field(slm.grid, test_wavelength);
  CameraParams camera;
  camera.pupil = 4_um;
  EXPECT_EQ(error_of([&] { look(field, slm, 0.1, {}, camera); }),
            "expected a pupil that holds a sample of the field, got one of 4 µm among samples 8 µm apart; take one of "
            "11.3137 µm or more");
  camera.eye.x = 1_mm;
  EXPECT_EQ(
      error_of([&] { look(field, slm, 0.1, {}, camera); }),
      "expected a pupil within the panel's window of 512 µm × 512 µm, got one of 4 µm at 1 mm, 0 m; move the eye");
}

TEST(Camera, AnEyeOutsideTheEyeboxIsToldAndSeesWhatOrdersGoThere) {
  Slm slm = make_panel(252, 252, 256, 0.87);
  const Hologram flat = make_hologram(slm, Modulation::phase, [](int) { return 0; });
  CameraParams camera;
  camera.pupil = 3_mm;
  camera.eye = {100_mm * test_wavelength / test_pitch, 0, 100_mm};
  ShowParams params;
  for (const int subpixels : {1, 3}) {
    params.subpixels = subpixels;
    Heard heard;
    const Image view = look(show(flat, slm, params), slm, 0, {}, camera, heard.observer());
    double light = 0;
    for (const float v : view.values) light += double(v) * view.pitch * view.pitch;
    const double expected = subpixels == 1 ? 0 : 0.00388;
    EXPECT_NEAR(light / (slm.grid.width() * slm.grid.height()), expected, 0.04 * expected);
    ASSERT_EQ(heard.warnings.size(), 1u);
    EXPECT_EQ(heard.warnings[0],
              std::string("the eye at 6.65 mm, 0 m is outside the eyebox (6.65368 mm × 6.65368 mm at 100 mm from the "
                          "panel): less than half of order 0 reaches it, ") +
                  (subpixels == 1 ? "and higher orders need subpixels of 3 or more" : "and light of higher orders") +
                  "; move the eye to |x| ≤ 3.32684 mm, |y| ≤ 3.32684 mm");
  }
  // With a plane in front of the panel, the same eye sees none of it: the light of a real image misses its pupil.
  Heard of_real_image;
  Field real = show(flat, slm, params);
  real.image = ImageSide::real_image;
  for (const float v : look(real, slm, 99_mm, {}, camera, of_real_image.observer()).values) ASSERT_EQ(v, 0);
  EXPECT_EQ(of_real_image.warnings.size(), 1u);
  camera.eye.x = 3.3_mm;  // inside the middle's cone of 3.33 mm
  Heard heard;
  look(show(flat, slm, params), slm, 0, {}, camera, heard.observer());
  EXPECT_TRUE(heard.warnings.empty());
}

// Behind a stop of half width f, order 0 reaches the angle asin(λf): at z = 100 mm it is z·λf/√(1 − λ²f²) from the axis.
TEST(Camera, AStopNarrowsTheEyeboxToItsCone) {
  const Slm slm = make_panel(64, 48);
  Field shown(slm.grid, test_wavelength);
  std::fill(shown.samples.values.begin(), shown.samples.values.end(), 1.0F);
  shown.filter = SpectralFilter{0, 0, 1 / (4 * test_pitch), 1 / (8 * test_pitch)};
  const double sine_x = test_wavelength / (4 * test_pitch), sine_y = sine_x / 2;
  const double right = 0.1 * sine_x / std::sqrt(1 - sine_x * sine_x);
  const double up = 0.1 * sine_y / std::sqrt(1 - sine_y * sine_y);
  CameraParams camera;
  camera.pupil = 3_mm;
  for (const bool is_beyond : {false, true})
    for (const Vec3 edge : {Vec3{right, 0, 0.1}, Vec3{0, up, 0.1}}) {
      const double part = is_beyond ? 1.01 : 0.99;
      camera.eye = {part * edge.x, part * edge.y, edge.z};
      Heard heard;
      look(shown, slm, 0, {}, camera, heard.observer());
      EXPECT_EQ(heard.warnings.size(), is_beyond ? 1u : 0u) << camera.eye.x << ", " << camera.eye.y;
    }
}

// A stop spreads the light of the first column over its neighbours, sinc(0.4) of it in amplitude at the next. If the field
// were periodic, the last column would be a neighbour, and have 0.57 of the light. In truth its share is below
// (1/(0.4π·63))² = 1.6e-4.
TEST(Camera, AStopBringsNoLightInFromTheOppositeEdge) {
  const Slm slm = make_panel(64, 48);
  Field shown(slm.grid, test_wavelength);
  for (int j = 0; j < 48; ++j) shown.samples(j, 0) = 1;
  shown.filter = SpectralFilter{0, 0, 0.4 / (2 * test_pitch), 1e6};
  CameraParams camera;
  camera.binning = 1;
  const Image view = look(shown, slm, 0, {}, camera);
  ASSERT_EQ(view.nx, 64);
  EXPECT_LT(view(24, 63), 0.002 * view(24, 0));
  EXPECT_GT(view(24, 1), 0.3 * view(24, 0));  // sinc² = 0.57, and a mean over the pixel
}

}  // namespace
}  // namespace holotrace
