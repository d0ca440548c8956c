#include "holotrace/view/camera.h"
#include "holotrace/view/compare.h"
#include "holotrace/view/expose.h"
#include "support/panels.h"

namespace holotrace {
namespace {

constexpr PixelSampling point = PixelSampling::point;

/// The view of a sensor in the field's own plane.
Image seen_in_place(const Field& field, CameraParams camera, const Observer& observer = {}) {
  camera.centre_x = field.grid.centre_x;
  camera.centre_y = field.grid.centre_y;
  return look(field, {.grid = field.grid}, 0, {}, camera, observer);
}

TEST(Expose, OfPointsIsTheirMeanIrradiance) {
  Field f({6, 4, 2e-6}, test_wavelength);
  for (size_t i = 0; i < f.samples.size(); ++i) f.samples.values[i] = {float(i), 1};
  const Image image = seen_in_place(f, {.binning = 2, .sampling = point});
  EXPECT_EQ(image.nx, 3);
  EXPECT_EQ(image.ny, 2);
  EXPECT_DOUBLE_EQ(image.pitch, 4e-6);
  // Samples 8, 9, 14, 15 of rows of 6: (64 + 81 + 196 + 225)/4 + 1.
  EXPECT_FLOAT_EQ(image(0, 1), (2 * 2 + 3 * 3 + 8 * 8 + 9 * 9) / 4.0F + 1);
  EXPECT_FLOAT_EQ(image(1, 1), (14 * 14 + 15 * 15 + 20 * 20 + 21 * 21) / 4.0F + 1);
  double light = 0;
  for (float v : image.values) light += v;
  EXPECT_NEAR(light * image.pitch * image.pitch, power(f), 1e-6 * power(f));  // no light is lost
}

TEST(Expose, OfPointsWithoutBinningIsTheSquaredModulus) {
  const Field f = sum_of(random_waves(3, 4, 1), {16, 8, test_pitch});
  const Image image = seen_in_place(f, {.sampling = point});
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 16; ++i) EXPECT_FLOAT_EQ(image(j, i), std::norm(f.samples(j, i)));
}

// Two plane waves of slopes ±1/2P make fringes of the irradiance 1 + cos(2πx/P + φ). A pixel of side p keeps their
// contrast times sinc(p/P), wherever its middle lies in a fringe. The window has whole periods of no pixel or sample;
// its ends ring, so only pixels in its middle count. To 1 %: the figure of mean_over_pixels for speckle, whose fringes
// have all periods. Points keep all of the contrast, and show fringes shorter than two pixels as longer ones.
TEST(Expose, APixelKeepsOfFringesTheSincOfItsSide) {
  const int nx = 1200, ny = 240;  // the ends ring by 1/2πd at d samples from them: 0.1 % of u
  for (const int binning : {1, 2, 3})
    for (const double period : {1.3, 1.7, 2.4, 3.9, 7.7, 31.0}) {  // in samples: |u|² has twice the field's band
      Field f({nx, ny, test_pitch}, test_wavelength);
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) f.samples(j, i) = float(std::sqrt(2.0) * std::cos(pi * i / period + 0.3));
      const Image image = seen_in_place(f, {.binning = binning});
      // A pixel's middle is at sample k·binning + (binning − 1)/2.
      const double side = binning / period, kept = std::sin(pi * side) / (pi * side);
      double off = 0, count = 0;
      for (int k = image.nx / 3; k < 2 * image.nx / 3; ++k, ++count) {
        const double place = k * binning + (binning - 1) / 2.0;
        const double wanted = 1 + kept * std::cos(2 * pi * place / period + 0.6);
        off += std::pow(image(image.ny / 2, k) - wanted, 2);
      }
      EXPECT_LT(std::sqrt(off / count), 0.01) << binning << " samples, period " << period;
    }
}

// The contrast that mean_over_pixels keeps of a fringe cos(2πfx), f in cycles per sample, compared with sinc(n·f), to
// the accuracy stated in its header for all frequencies up to Nyquist: 0.006 at even n, and the values for odd n.
TEST(MeanOverPixels, KeepsFringesAsWellAsItsHeaderStates) {
  const double stated[] = {0.09, 0.006, 0.03, 0.006, 0.018, 0.006, 0.013, 0.006};
  for (int n = 1; n <= 8; ++n) {
    double worst = 0;
    for (int k = 0; k <= 50; ++k) {
      const double f = k / 100.0;
      Array2D<float> values(n + 2 * integration_rim, n + 2 * integration_rim);
      // Symmetric about the pixel's middle, where the fringe is brightest: 2 + cos is above 0.
      for (int j = 0; j < values.ny; ++j)
        for (int i = 0; i < values.nx; ++i)
          values(j, i) = float(2 + std::cos(2 * pi * f * (i - integration_rim - (n - 1) / 2.0)));
      const Image image = mean_over_pixels(values, n, integration_rim, true);
      worst = std::max(worst, std::abs(image(0, 0) - 2 - sinc(n * f)));
    }
    EXPECT_LT(worst, stated[n - 1]) << n;
    EXPECT_GT(worst, stated[n - 1] * 0.8) << n << ": the header states more than is so";
  }
}

TEST(Expose, CropsEvenlyAndSaysSo) {
  Field f({8, 5, test_pitch}, test_wavelength);
  f.samples(1, 1) = 3;
  Heard heard;
  const Image image = seen_in_place(f, {.binning = 3, .sampling = point}, heard.observer());
  EXPECT_EQ(image.nx, 2);
  EXPECT_EQ(image.ny, 1);
  EXPECT_FLOAT_EQ(image(0, 0), 1);  // mean of 9 over 9 samples: column 1 and row 1 are the first ones kept
  ASSERT_EQ(heard.warnings.size(), 1u);
  EXPECT_EQ(
      heard.warnings[0],
      "the field of 8 × 5 samples does not divide into bins of 3 × 3: only 6 × 3 samples of it are used; choose a "
      "binning that divides both numbers");
}

TEST(Expose, APixelLiesWhereItsSamplesLie) {
  // Of 7 × 8 samples in bins of 3, one column is left over (the right one) and two rows, one of them at the top.
  const Field f({7, 8, test_pitch, 1e-3, -2e-3}, test_wavelength);
  for (const PixelSampling sampling : {PixelSampling::integrate, PixelSampling::point}) {
    const Image image = seen_in_place(f, {.binning = 3, .sampling = sampling});
    ASSERT_EQ(image.nx, 2);
    ASSERT_EQ(image.ny, 2);
    // Middles of the first pixel: sample 1 in x, sample 1 + 1 in y. Roundings of 1e-3 m.
    EXPECT_NEAR(image.centre_x - image.pitch / 2, f.grid.x(1), 1e-17);
    EXPECT_NEAR(image.centre_y + image.pitch / 2, f.grid.y(2), 1e-17);
  }
}

TEST(Expose, SaysWhatIsWrong) {
  const Field f({8, 5, test_pitch}, test_wavelength);
  EXPECT_EQ(error_of([&] { seen_in_place(f, {.binning = 6}); }),
            "expected a binning of 1 to 5 samples, the side of the field, or 0 for 1, got 6");
  EXPECT_EQ(error_of([&] { seen_in_place(f, {.binning = -1}); }),
            "expected a whole number of 0 or more for \"binning\", got -1");
}

TEST(ExposureWhite, ShowsWhiteSurfacesAtFourFifths) {
  Image surface(64, 64, 1);
  for (int j = 8; j < 40; ++j)
    for (int i = 16; i < 56; ++i) surface(j, i) = 3;
  EXPECT_DOUBLE_EQ(exposure_white(surface, 0), 3 * 1.25);
  EXPECT_EQ(exposure_white(surface, 0.25), 0.25);
  EXPECT_EQ(exposure_white(Image(4, 4, 1), 0), 1);  // dark
  EXPECT_NE(error_of([&] { exposure_white(surface, -1); }), "no error");
}

// 50 of 10,000 blocks are a surface of 5 before a wall of 1: more than a thousandth of the picture, so it sets the white.
TEST(ExposureWhite, IsThatOfASmallBrightSurface) {
  Image picture(800, 800, 1);
  for (int j = 0; j < 800; ++j)
    for (int i = 0; i < 800; ++i) picture(j, i) = j < 8 && i < 400 ? 5 : 1;
  EXPECT_DOUBLE_EQ(exposure_white(picture, 0), 5 * 1.25);
}

TEST(ExposureWhite, ClipsATenthOfTheLightOfAPoint) {
  Image star(800, 800, 1);  // 10,000 blocks, so that the block of the star is above the percentile
  star(3, 4) = 5;
  EXPECT_NEAR(exposure_white(star, 0), 0.9 * 5, 1e-5);  // 24 bisections
}

// Fully developed speckle of mean 1 has ∫ (I − W)·exp(−I) dI = exp(−W) above W: a tenth of the light lies above ln 10.
TEST(ExposureWhite, ClipsATenthOfTheLightOfSpeckle) {
  Image speckle(512, 512, 1);
  for (size_t i = 0; i < speckle.values.size(); ++i)
    speckle.values[i] =
        float(-std::log((double(i * 104729 % speckle.values.size()) + 0.5) / double(speckle.values.size())));
  EXPECT_NEAR(exposure_white(speckle, 0), std::log(10.0), 1e-3);  // the sum of 2.6e5 values in place of the integral
}

// Against the sum over all values at every level: the light above the result is a tenth, to the 24 bisections.
TEST(ExposureWhite, ClipsATenthOfAnyLight) {
  for (const double power : {1.0, 3.0, 9.0}) {  // ever more of the light in ever fewer pixels
    Image image(64, 80, 1);
    for (size_t i = 0; i < image.values.size(); ++i)
      image.values[i] =
          float(std::pow(double(i * 104729 % image.values.size()) / double(image.values.size()), power)) - 1e-3F;
    for (int i = 0; i < 40; ++i) image.values[size_t(i) * 7] = 30;
    const double white = exposure_white(image, 0);
    double light = 0, above = 0;
    for (const float v : image.values) {
      light += std::max(0.0, double(v));
      above += std::max(0.0, double(v) - white);
    }
    EXPECT_NEAR(above / light, 0.1, 1e-5) << power;
  }
}

TEST(Speckle, ExponentialIntensityHasContrastOne) {
  // Sum of M frames of circular Gaussian fields: contrast 1/√M; its standard error over n pixels is
  // √((1 + 1/M)/2n)/√M (delta method on the Gamma distribution). 4 standard errors, fixed seed.
  for (int frames : {1, 4, 16}) {
    const int side = 128;
    Image image(side, side, 1);
    for (int frame = 0; frame < frames; ++frame) {
      Field f({side, side, test_pitch}, test_wavelength);
      for (size_t i = 0; i < f.samples.size(); ++i) {
        CounterRandom random(42, uint32_t(frame), i);
        const double radius = std::sqrt(-std::log(1 - random.uniform()));
        f.samples.values[i] = std::complex<float>(std::polar(radius, 2 * pi * random.uniform()));
      }
      const Image seen = seen_in_place(f, {.sampling = point});  // independent pixels
      for (size_t i = 0; i < image.values.size(); ++i) image.values[i] += seen.values[i];
    }
    const double n = double(side) * side;
    const double standard_error = std::sqrt((1 + 1.0 / frames) / (2 * n) / frames);
    EXPECT_NEAR(speckle_contrast(image), 1 / std::sqrt(frames), 4 * standard_error) << frames;

    // Compared with a shaded reference, the shading divides out.
    Image shading(side, side, 1);
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        shading(j, i) = 0.2F + float(i) / side;
        image(j, i) *= shading(j, i);
      }
    EXPECT_NEAR(compare(shading, image).speckle_contrast, 1 / std::sqrt(frames), 4 * standard_error) << frames;
  }
}

}  // namespace
}  // namespace holotrace
