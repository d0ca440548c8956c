#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <vector>

#include "holotrace/base/random.h"
#include "holotrace/denoise/denoise.h"
#include "support/denoiser.h"
#include "support/error_of.h"

namespace holotrace {
namespace {

constexpr int side = 192;

// Smooth light, with a bright disc and dark stripes.
double light_at(double row, double column) {
  const double smooth = 0.6 + 0.4 * std::sin(column / 40) * std::cos(row / 55);
  if (std::hypot(row - 60, column - 70) < 35) return 3 * smooth;
  return row > 120 && int(column / 8) % 2 == 0 ? 0.2 * smooth : smooth;
}

Image truth_of(int channels) {
  Image image(side, side, channels);
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      for (int channel = 0; channel < channels; ++channel)
        image(row, column, channel) = float((1 - 0.3 * channel) * light_at(row, column));
  return image;
}

// Each pixel is a mean of light paths, with exponentially distributed light: a relative error of 1/√paths.
Image with_noise(const Image& truth, int paths, uint64_t seed = 1) {
  Image image = truth;
  for (size_t pixel = 0; pixel < truth.values.size() / size_t(truth.channels); ++pixel) {
    CounterRandom random(seed, 0, pixel);
    double sum = 0;
    for (int path = 0; path < paths; ++path) sum -= std::log(1 - random.uniform());
    for (int channel = 0; channel < truth.channels; ++channel)
      image.values[pixel * size_t(truth.channels) + size_t(channel)] *= float(sum / paths);
  }
  return image;
}

double squared_error(const Image& image, const Image& truth) {
  double sum = 0;
  for (size_t i = 0; i < truth.values.size(); ++i) sum += std::pow(double(image.values[i]) - truth.values[i], 2);
  return sum;
}

double mean_over(const Image& image, int top, int left, int size) {
  double sum = 0;
  for (int row = top; row < top + size; ++row)
    for (int column = left; column < left + size; ++column)
      for (int channel = 0; channel < image.channels; ++channel) sum += image(row, column, channel);
  return sum / (double(size) * size * image.channels);
}

TEST(Denoise, TakesMostOfTheNoiseFromPicturesOfOneAndOfThreeChannels) {
  HOLOTRACE_NEEDS_DENOISER();
  for (const int channels : {1, 3}) {
    const Image truth = truth_of(channels), noisy = with_noise(truth, 8);
    // Light paths alone would need 10 times as many for a tenth of the squared error.
    EXPECT_LT(squared_error(denoise(noisy), truth), squared_error(noisy, truth) / 10) << channels;
    EXPECT_LT(squared_error(denoise(noisy, {}, DenoiseQuality::fast), truth), squared_error(noisy, truth) / 10);
  }
}

TEST(Denoise, KeepsTheMeansOfRegions) {
  HOLOTRACE_NEEDS_DENOISER();
  const Image truth = truth_of(3);
  for (const int paths : {4, 16}) {
    const Image noisy = with_noise(truth, paths), denoised = denoise(noisy);
    for (int top = 0; top < side; top += 64)
      for (int left = 0; left < side; left += 64) {
        const double converged = mean_over(truth, top, left, 64), of_paths = mean_over(noisy, top, left, 64);
        // 0.5 % beside the error that the light paths have over the region: 3/√(paths·64²)
        EXPECT_NEAR(mean_over(denoised, top, left, 64) / converged, 1, 0.005 + 3 / std::sqrt(paths * 64.0 * 64.0));
        EXPECT_NEAR(mean_over(denoised, top, left, 64) / of_paths, 1, 0.005);
      }
  }
}

TEST(Denoise, IsTheSameForBrightAndForDimLight) {
  HOLOTRACE_NEEDS_DENOISER();
  const Image noisy = with_noise(truth_of(3), 16);
  const Image denoised = denoise(noisy);
  for (const float factor : {1e-6F, 1e6F}) {
    Image other = noisy;
    for (float& value : other.values) value *= factor;
    Image back = denoise(other);
    for (float& value : back.values) value /= factor;
    // The network scales light to its own range; its powers of ten have errors of rounding only, which edges enlarge.
    EXPECT_LT(squared_error(back, denoised), 1e-6 * squared_error(denoised, Image(side, side, 3))) << factor;
  }
}

TEST(Denoise, HasTheSameBytesOnAnyNumberOfThreads) {
  HOLOTRACE_NEEDS_DENOISER();
  const Image noisy = with_noise(truth_of(3), 4);
  const auto on = [&](size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return denoise(noisy).values;
  };
  const std::vector<float> one = on(1);
  EXPECT_EQ(one, on(2));
  EXPECT_EQ(one, on(5));
}

TEST(Denoise, LeavesBlackSurroundingsAndTinyPicturesAsTheyAre) {
  HOLOTRACE_NEEDS_DENOISER();
  EXPECT_EQ(denoise(Image(40, 30, 3)).values, Image(40, 30, 3).values) << "black";
  for (const auto& [rows, columns] : {std::pair(1, 1), std::pair(15, 40), std::pair(40, 15)}) {
    Image tiny(rows, columns, 1);
    for (size_t i = 0; i < tiny.values.size(); ++i) tiny.values[i] = float(i % 7);
    EXPECT_EQ(denoise(tiny).values, tiny.values) << rows << " x " << columns;
  }
  Image least(16, 16, 3);
  for (size_t i = 0; i < least.values.size(); ++i) least.values[i] = float(i % 7);
  EXPECT_NE(denoise(least).values, least.values);

  // Light in a part of a black picture: the part, with a margin of 16 pixels, alone gives the same.
  const Image lit = with_noise(truth_of(3), 4);
  const int margin = 16, top = 50, left = 90;
  Image part(side + 2 * margin, side + 2 * margin, 3), whole(side + 150, side + 200, 3);
  for (int row = 0; row < side; ++row)
    for (int i = 0; i < 3 * side; ++i)
      (&part(row + margin, margin, 0))[i] = (&whole(row + top, left, 0))[i] = lit(row, 0, i);
  part = denoise(part);
  whole = denoise(whole);
  for (int row = 0; row < whole.ny; ++row)
    for (int i = 0; i < 3 * whole.nx; ++i) {
      const int r = row - top + margin, c = i - 3 * (left - margin);
      const bool is_inside = r >= 0 && r < part.ny && c >= 0 && c < 3 * part.nx;
      ASSERT_EQ(whole(row, 0, i), is_inside ? part(r, 0, c) : 0) << row << " " << i;
    }
}

TEST(Denoise, GreyStaysGrey) {
  HOLOTRACE_NEEDS_DENOISER();
  const Image one = with_noise(truth_of(1), 4);
  Image grey(side, side, 3);
  grey.pitch = 3e-6;
  for (size_t i = 0; i < grey.values.size(); ++i) grey.values[i] = one.values[i / 3];
  const Image denoised = denoise(grey), of_one = denoise(one);
  EXPECT_EQ(denoised.pitch, grey.pitch);
  for (size_t i = 0; i < grey.values.size(); ++i) ASSERT_EQ(denoised.values[i], of_one.values[i / 3]) << i;
}

TEST(Denoise, OneBrightPixelDoesNotBrightenItsNeighbourhood) {
  HOLOTRACE_NEEDS_DENOISER();
  Image noisy(side, side, 3);
  for (float& value : noisy.values) value = 1;
  noisy = with_noise(noisy, 64);
  for (int channel = 0; channel < 3; ++channel) noisy(96, 96, channel) = 1e4F;
  const Image denoised = denoise(noisy);
  // The factor is at most 1.25, and the pixel's own light may reach the next ones.
  for (int column = 0; column < side; ++column) {
    if (std::abs(column - 96) <= 4) continue;
    EXPECT_NEAR(denoised(96, column, 1), 1, 0.4) << column;
  }
}

TEST(Denoise, GuidesKeepTextureThatNoiseHides) {
  HOLOTRACE_NEEDS_DENOISER();
  Image truth(side, side, 3);
  DenoiseGuides guides{truth, truth};
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      for (int channel = 0; channel < 3; ++channel) {
        const float reflectance = (row / 3 + column / 3) % 2 == 0 ? 0.4F : 0.6F;  // a tenth of the noise below
        truth(row, column, channel) = guides.albedo(row, column, channel) = reflectance;
        guides.normals(row, column, channel) = channel == 2 ? 1 : 0;
      }
  const Image noisy = with_noise(truth, 2);
  EXPECT_LT(squared_error(denoise(noisy, guides), truth), squared_error(denoise(noisy), truth) / 2);
}

TEST(Denoise, ReportsProgressAndEndsWhereTheObserverThrows) {
  HOLOTRACE_NEEDS_DENOISER();
  const Image noisy = with_noise(truth_of(3), 4);
  double last = 0;
  Observer observer;
  observer.on_progress = [&](double fraction) {
    EXPECT_GE(fraction, last);
    last = fraction;
  };
  const Image denoised = denoise(noisy, {}, DenoiseQuality::high, observer);
  EXPECT_EQ(last, 1);
  struct Stopped {};
  observer.on_progress = [](double) { throw Stopped(); };
  EXPECT_THROW(denoise(noisy, {}, DenoiseQuality::high, observer), Stopped);
  EXPECT_EQ(denoise(noisy).values, denoised.values) << "after an end before time";
}

TEST(Denoise, RefusesWhatIsNoPictureOfLight) {
  EXPECT_EQ(error_of([] { denoise(Image()); }),
            "expected a picture of 1 or 3 channels to denoise, got 0 x 0 pixels and 1 channel(s)");
  EXPECT_EQ(error_of([] { denoise(Image(20, 30, 2)); }),
            "expected a picture of 1 or 3 channels to denoise, got 30 x 20 pixels and 2 channel(s)");
  for (const auto& [value, text] : {std::pair(std::numeric_limits<float>::quiet_NaN(), "nan"),
                                    std::pair(std::numeric_limits<float>::infinity(), "inf"), std::pair(-1.0F, "-1")}) {
    Image image(20, 20, 3);
    image(3, 4, 1) = value;
    EXPECT_EQ(
        error_of([&] { denoise(image); }),
        fmt::format("expected finite light of 0 or more in a picture to denoise, got {}; set such pixels to 0", text));
  }
  const Image image(20, 30, 3);
  EXPECT_EQ(error_of([&] {
              denoise(image, {image, {}});
            }),
            "expected normals on the picture's 30 x 20 pixels, in three channels, got 0 x 0 and 1");
  EXPECT_EQ(error_of([&] {
              denoise(image, {Image(20, 30, 1), image});
            }),
            "expected albedo on the picture's 30 x 20 pixels, in three channels, got 30 x 20 and 1");
}

}  // namespace
}  // namespace holotrace
