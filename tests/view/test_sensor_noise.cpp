#include <cmath>

#include "holotrace/view/sensor.h"
#include "support/panels.h"
#include "support/statistics.h"

namespace holotrace {
namespace {

Image even_image(int side, float value) {
  Image image(side, side, 1);
  std::fill(image.values.begin(), image.values.end(), value);
  return image;
}

struct Moments {
  double mean = 0, variance = 0;
};

// Mean and variance of the electrons of a reading.
Moments electrons_of(const Image& reading, double white, double full_well) {
  Moments m;
  for (const float v : reading.values) m.mean += double(v) / white * full_well / double(reading.values.size());
  for (const float v : reading.values)
    m.variance += std::pow(double(v) / white * full_well - m.mean, 2) / double(reading.values.size());
  return m;
}

// For N = 256² pixels far below the full well, the mean has the standard error √(V/N), and the variance V has
// V·√((2 + κ)/N), where κ = mean/V² is the excess kurtosis of a Poisson plus a normal number. `deviations`: 6e-5 each.
TEST(SensorNoise, MeanIsTheLightAndVarianceIsTheElectronsAndTheReadersSquare) {
  for (const double mean : {0.4, 3.0, 40.0, 2000.0})
    for (const double read_noise : {0.0, 6.0}) {
      if (mean < 20 && read_noise > 0) continue;  // readings would be clipped at 0
      CameraParams camera;
      camera.electrons = 20000;
      camera.read_noise = read_noise;
      const double white = 5;
      const Image view = even_image(256, float(mean / camera.electrons * white));
      const Moments m = electrons_of(add_sensor_noise(view, white, camera), white, camera.electrons);
      const double pixels = 256.0 * 256.0, variance = mean + read_noise * read_noise;
      const double kurtosis = mean / (variance * variance);
      // Floats of the picture: 6e-8 of the mean; the statistical errors are 1e-3 of it.
      EXPECT_NEAR(m.mean, mean, deviations * std::sqrt(variance / pixels)) << mean << " ± " << read_noise;
      EXPECT_NEAR(m.variance, variance, deviations * variance * std::sqrt((2 + kurtosis) / pixels))
          << mean << " ± " << read_noise;
    }
}

TEST(SensorNoise, CountsAreThoseOfPoissonsLaw) {
  CameraParams camera;
  camera.electrons = 100;
  constexpr double mean = 7;
  const Image reading = add_sensor_noise(even_image(128, float(mean / 100)), 1, camera);
  constexpr size_t most = 30;
  std::vector<double> counts(most + 1), expected(most + 1);
  for (const float v : reading.values) counts[std::min(most, size_t(std::lround(v * 100)))] += 1;
  double left = 1;
  for (size_t n = 0; n < most; ++n) {
    const double chance = std::exp(double(n) * std::log(mean) - mean - std::lgamma(double(n) + 1));
    expected[n] = chance * 128 * 128;
    left -= chance;
  }
  expected[most] = left * 128 * 128;
  EXPECT_GT(chi_square(counts, expected).p_value, 1e-3);
}

TEST(SensorNoise, APixelHoldsNoMoreThanItsFullWellAndNoLessThanNothing) {
  CameraParams camera;
  camera.electrons = 1000;
  camera.read_noise = 5;
  const Image bright = add_sensor_noise(even_image(32, 1.5F), 1, camera);  // 500 electrons, 13σ, above the well
  for (const float v : bright.values) ASSERT_EQ(v, 1);
  const Image dark = add_sensor_noise(even_image(64, 0), 1, camera);
  int cut = 0;
  for (const float v : dark.values) {
    ASSERT_GE(v, 0);
    cut += v == 0;
  }
  // Read noise is symmetric: half of 4096, with standard deviation 32.
  EXPECT_NEAR(cut, 2048, deviations * 32);
  Image negative = even_image(4, -0.1F);  // as in colours whose speckle differs
  camera.read_noise = 0;
  for (const float v : add_sensor_noise(negative, 1, camera).values) EXPECT_EQ(v, 0);
}

TEST(SensorNoise, NoiseIsTheSeedsAndTheExposuresAlone) {
  CameraParams camera;
  const Image view = even_image(16, 0.5F);
  EXPECT_EQ(add_sensor_noise(view, 1, camera).values, view.values);  // no electrons: no noise
  camera.electrons = 500;
  const auto first = add_sensor_noise(view, 1, camera).values;
  EXPECT_EQ(add_sensor_noise(view, 1, camera).values, first);
  EXPECT_NE(add_sensor_noise(view, 1, camera, 1).values, first);
  camera.noise_seed = 2;
  EXPECT_NE(add_sensor_noise(view, 1, camera).values, first);
}

// Frames are added up before they are read: two of half the light equal one of full light, with the noise of one
// reading.
TEST(SensorNoise, NoiseOfOneExposureFallsWithTheRootOfItsElectrons) {
  for (const double electrons : {100.0, 10000.0}) {
    CameraParams camera;
    camera.electrons = electrons;
    const Moments m = electrons_of(add_sensor_noise(even_image(128, 0.25F), 1, camera), 1, electrons);
    const double relative = std::sqrt(m.variance) / m.mean, expected = 1 / std::sqrt(0.25 * electrons);
    // σ of a standard deviation from 128² numbers: 1/√(2·128²) = 0.55 %.
    EXPECT_NEAR(relative / expected, 1, deviations * 0.0055);
  }
}

TEST(SensorNoise, SensorsThatCannotBeAreRefused) {
  const Image view = even_image(4, 0.5F);
  CameraParams camera;
  camera.electrons = -1;
  EXPECT_EQ(error_of([&] { add_sensor_noise(view, 1, camera); }),
            "expected a number from 0 to 1000000000000 for \"electrons\", got -1");
  camera.electrons = 0;
  camera.read_noise = 3;
  EXPECT_EQ(error_of([&] { add_sensor_noise(view, 1, camera); }),
            "expected electrons above 0 with a read noise of 3 electrons, got 0; set electrons");
  camera.read_noise = -3;
  EXPECT_EQ(error_of([&] { add_sensor_noise(view, 1, camera); }),
            "expected a number of 0 or more for \"read_noise\", got -3");
  camera = {};
  camera.electrons = 10;
  EXPECT_EQ(error_of([&] { add_sensor_noise(view, 0, camera); }), "expected a white above 0 W/m², got 0 W/m²");
}

}  // namespace
}  // namespace holotrace
