#include <algorithm>
#include <cmath>

#include "holotrace/data/spectrum.h"
#include "holotrace/slm/encode/encode.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/combine_views.h"
#include "holotrace/view/compare.h"
#include "support/panels.h"

namespace holotrace {
namespace {

Image flat(float value, int n = 2) {
  Image image(n, n, 1);
  image.pitch = test_pitch;
  for (float& v : image.values) v = value;
  return image;
}

TEST(CombinedViews, OneHologramIsItsView) {
  CombinedViews sum;
  Image view = flat(1.5F);
  view.values[1] = 0.1F;
  sum.add(532e-9, "", 0.0037, view);
  EXPECT_EQ(sum.image().values, view.values);  // to the last bit, for any illumination
  EXPECT_EQ(sum.image().channels, 1);
  EXPECT_EQ(sum.image().pitch, test_pitch);
}

TEST(CombinedViews, FramesAreAveragedAndSetsAreAdded) {
  CombinedViews sum;
  sum.add(532e-9, "sun", 2, flat(1));
  sum.add(532e-9, "sun", 2, flat(3));
  sum.add(532e-9, "lamp", 1, flat(8));
  // (1 + 3)/2 fully lit, and 8 at half the light.
  for (float v : sum.image().values) EXPECT_FLOAT_EQ(v, 6);
  EXPECT_DOUBLE_EQ(sum.mean_irradiance(), 6);
  EXPECT_DOUBLE_EQ(sum.relative_illumination(), 1.5);
}

TEST(CombinedViews, ColoursKeepTheRatioOfTheirIlluminations) {
  const std::vector<double> wavelengths{638e-9, 520e-9, 450e-9};
  const Vec3 rgb{0.9, 0.5, 0.2};
  CombinedViews sum;
  for (const double wavelength : wavelengths) sum.add(wavelength, "", 7 * radiance_at(wavelength, rgb), flat(2));
  const Image image = sum.image();
  ASSERT_EQ(image.channels, 3);
  // Red, 0.9, is the brightest: it is shown as 2. Floats: 1e-6.
  EXPECT_NEAR(image(0, 0, 0), 2, 2e-6);
  EXPECT_NEAR(image(1, 1, 1), 2 * rgb.y / 0.9, 2e-6);
  EXPECT_NEAR(image(1, 0, 2), 2 * rgb.z / 0.9, 2e-6);
}

TEST(CombinedViews, AWavelengthThatNoHologramHasIsDark) {
  CombinedViews sum({638e-9, 520e-9, 460e-9});
  sum.add(460e-9, "", 1, flat(3));
  const Image image = sum.image();
  ASSERT_EQ(image.channels, 3);
  EXPECT_NEAR(image(0, 0, 0), 0, 1e-6);
  EXPECT_NEAR(image(0, 0, 2), 3, 1e-6);
}

TEST(CombinedViews, TheWhiteIsBalancedByTheReach) {
  CombinedViews sum;
  sum.add(638e-9, "", 1, flat(4), 4);
  sum.add(520e-9, "", 1, flat(2), 2);
  sum.add(450e-9, "", 1, flat(1), 1);
  for (float v : sum.image().values) EXPECT_NEAR(v, 4, 1e-5);
}

TEST(CombinedViews, RefusesWhatDoesNotAddUp) {
  CombinedViews sum;
  EXPECT_EQ(error_of([&] { sum.image(); }), "expected a view to make a picture of, got none");
  sum.add(532e-9, "", 1, flat(1, 2));
  EXPECT_EQ(error_of([&] { sum.add(532e-9, "", 1, flat(1, 3)); }),
            "expected views of one size to add up, 2 × 2 pixels, got 3 × 3; show holograms of one panel");
  EXPECT_EQ(error_of([&] { sum.add(532e-9, "", -1, flat(1, 2)); }),
            "expected an illumination of 0 W/m² or more, got -1 W/m²");
}

TEST(SeenAt, IsTheRadianceOfOneWavelengthAndTheColourOfThree) {
  Image rgb(1, 1, 3);
  rgb.values = {0.2F, 0.5F, 0.9F};
  EXPECT_NEAR(seen_at(rgb, {638e-9}).values[0], 0.2, 1e-7);
  const Image same = seen_at(rgb, {638e-9, 520e-9, 450e-9});
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(same.values[i], rgb.values[i], 1e-6);
}

TEST(AxialReach, IsTheWholePanelFarAwayAndTheAcceptanceNearby) {
  Slm slm = make_panel(256, 192);
  slm.fill_factor = 1e-12;  // no roll-off: only areas matter
  EXPECT_NEAR(axial_reach(slm, {532e-9}, 10, {}), 1, 1e-9);
  // At 10 mm the box's half side is 10 mm·tan(asin(λ/2p)), inside the panel's 1.024 and 0.768 mm.
  const double sine = 532e-9 / 16e-6, box = 0.01 * sine / std::sqrt(1 - sine * sine);
  EXPECT_NEAR(axial_reach(slm, {532e-9}, 0.01, {}), 4 * box * box / (slm.grid.width() * slm.grid.height()), 1e-9);
  // Pixels without gaps pass ∫sinc² over the band |f| ≤ 1/2 per axis: 0.77369 of the light; small angles: 1e-3.
  slm.fill_factor = 1;
  EXPECT_NEAR(axial_reach(slm, {532e-9}, 0.01, {}) / (4 * box * box / (slm.grid.width() * slm.grid.height())),
              std::pow(0.7736950, 2), 1e-3);
  // Iterations undo the pixels' share of that; light of a target does not keep to the cone.
  const double cone = 4 * box * box / (slm.grid.width() * slm.grid.height());
  EXPECT_NEAR(axial_reach(slm, {.wavelength = 532e-9, .losses = {true, false}}, 0.01, {}), cone, 1e-9);
  EXPECT_EQ(axial_reach(slm, {.wavelength = 532e-9, .losses = {false, false}}, 0.01, {}), 1);
  EXPECT_LT(axial_reach(slm, {.wavelength = 532e-9, .losses = {false, true}}, 0.1, {}), 0.9999);
}

// A pupil of 20 mm receives all the light for a point 150 mm in front of the panel and 150 mm before the eye: its beam
// is as wide there as on the panel, at most 15.36 mm.
TEST(AxialReach, OfARealImageIsThatOfTheLightThatPassesThePupil) {
  const Slm slm{.name = "test", .grid = {1920, 1080, 8e-6}};
  const ImageSide real = ImageSide::real_image;
  CameraParams camera;
  const double all = axial_reach(slm, {532e-9, real}, 0.15, camera);
  EXPECT_LT(all, 0.9);  // not the whole panel: a pupil as for a virtual image would change it
  camera.pupil = 20e-3;
  camera.eye = {0, 0, 0.3};
  EXPECT_EQ(axial_reach(slm, {532e-9, real}, 0.15, camera), all);
  EXPECT_GT(axial_reach(slm, {532e-9}, 0.15, camera), all);
}

// Developed speckle: random plane waves over the whole band; each frame has other phases.
Field speckle(const Grid& grid, int band, uint32_t frame) {
  CounterRandom random(7, frame, 0);
  Field f(grid, test_wavelength);
  // The spectrum is even over |a|, |b| ≤ band: sums of waves by rows and then columns.
  const int n = 2 * band + 1;
  std::vector<std::complex<double>> weights(size_t(n) * size_t(n));
  for (auto& w : weights) w = std::polar(1.0, 2 * pi * random.uniform());
  std::vector<std::complex<double>> rows(size_t(n) * size_t(grid.nx));
  for (int b = 0; b < n; ++b)
    for (int i = 0; i < grid.nx; ++i) {
      std::complex<double> sum = 0;
      for (int a = 0; a < n; ++a)
        sum += weights[size_t(b * n + a)] * std::polar(1.0, 2 * pi * (a - band) * grid.x(i) / grid.width());
      rows[size_t(b) * size_t(grid.nx) + size_t(i)] = sum;
    }
  for (int j = 0; j < grid.ny; ++j)
    for (int i = 0; i < grid.nx; ++i) {
      std::complex<double> sum = 0;
      for (int b = 0; b < n; ++b)
        sum += rows[size_t(b) * size_t(grid.nx) + size_t(i)] *
               std::polar(1.0, 2 * pi * (b - band) * grid.y(j) / grid.height());
      f.samples(j, i) = std::complex<float>(sum);
    }
  return f;
}

TEST(CombinedViews, SpeckleFallsAsOneOverTheRootOfTheFrames) {
  // 97² = 9409 independent modes, one grain each. The contrast C = 1/√M of N grains is known to about 1/√N = 1 % (M =
  // 1), 1/√(2N) = 0.7 % (many frames); 3 % is three times that.
  const Grid grid{128, 128, test_pitch};
  CombinedViews sum;
  for (uint32_t frame = 0; frame < 16; ++frame) {
    const Field field = speckle(grid, 48, frame);
    Image view(grid.ny, grid.nx, 1);
    view.pitch = grid.pitch;
    for (size_t i = 0; i < view.values.size(); ++i) view.values[i] = std::norm(field.samples.values[i]);
    sum.add(test_wavelength, "", power(field), view);
    const uint32_t frames = frame + 1;
    if (frames == 1 || frames == 4 || frames == 16) {
      EXPECT_NEAR(speckle_contrast(sum.image()) * std::sqrt(frames), 1, 0.03) << frames;
    }
  }
}

TEST(CieColours, OfAViewAreThoseOfItsLight) {
  Image white(1, 1, 3);
  white.values = {0.5F, 0.5F, 0.5F};
  const Image seen = in_cie_colours(white, {638e-9, 520e-9, 450e-9});
  for (const float value : seen.values) EXPECT_NEAR(value, 0.5F, 1e-6) << "three lasers together are white";
  // A green laser alone: its colour, with the luminance of the light, and within sRGB.
  Image green(1, 1, 1);
  green.values = {0.5F};
  const Image shown = in_cie_colours(green, {520e-9});
  ASSERT_EQ(shown.channels, 3);
  EXPECT_GE(std::min({shown.values[0], shown.values[1], shown.values[2]}), 0.0F);
  EXPECT_GT(shown.values[1], 2 * shown.values[2]);
  // Weights of four digits, times components of 2 in all.
  EXPECT_NEAR(luminance(shown.values[0], shown.values[1], shown.values[2]), 0.5, 3e-4);
}

}  // namespace
}  // namespace holotrace
