#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numeric>

#include "holotrace/base/units.h"
#include "holotrace/view/diffraction_limit.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

const Grid limit_panel{128, 64, 8e-6};  // 1.024 mm × 0.512 mm

FocalStack stack_of(const Grid& grid, double distance, int channels = 1) {
  return {grid, {distance}, {Image(grid.ny, grid.nx, channels)}};
}

double sum_of(const Image& image) { return std::accumulate(image.values.begin(), image.values.end(), 0.0); }

/// Intensity in the plane in focus, at x, of the wave from a slit of that width at the distance d, by summing the
/// Fraunhofer integral over the slit; 1 at x = 0.
double slit_intensity(double width, double distance, double x) {
  const int points = 2000;
  std::complex<double> sum;
  for (int i = 0; i < points; ++i) {
    const double a = ((i + 0.5) / points - 0.5) * width;
    sum += std::polar(1.0 / points, 2 * pi * a * x / (green_light * distance));
  }
  return std::norm(sum);
}

TEST(DiffractionLimit, APointBecomesThePatternOfThePanel) {
  // λd/w = 0.2 m·532 nm/1.024 mm = 0.104 mm = 13 pixels across, 26 pixels up: the pixels resolve the pattern.
  const Grid grid{257, 257, 8e-6};
  FocalStack stack = stack_of(grid, 0.2);
  stack.pictures[0](128, 128) = 5;
  limit_to_panel(stack, limit_panel, green_light);
  const Image& image = stack.pictures[0];
  for (int step = 0; step <= 60; ++step) {
    // The pattern is reflected at the edges, 129 pixels away: (26/(π·129))² = 4e-3 of the peak at most, where it is added.
    EXPECT_NEAR(image(128, 128 + step) / image(128, 128), slit_intensity(limit_panel.width(), 0.2, step * 8e-6), 3e-3)
        << step;
    EXPECT_NEAR(image(128 + step, 128) / image(128, 128), slit_intensity(limit_panel.height(), 0.2, step * 8e-6), 8e-3)
        << step;
  }
  // Peak of c_x·c_y·sinc²·sinc² per pixel: pitch²·w·h/(λd)². The tails beyond the window come back: 2·26/(π²·129) of
  // the light.
  const double peak = 5 * 64e-12 * limit_panel.width() * limit_panel.height() / std::pow(green_light * 0.2, 2);
  EXPECT_NEAR(image(128, 128) / peak, 1, 0.01);
  EXPECT_NEAR(sum_of(image), 5, 1e-5) << "floats";
}

TEST(DiffractionLimit, GratingsKeepTheTriangleOfTheirFrequency) {
  // cos² fringes of k half periods over the window are their own reflection: contrast max(0, 1 − νλd/w) exactly.
  const Grid grid{120, 4, 8e-6};
  const double distance = 0.05, cutoff = limit_panel.width() / (green_light * distance);  // 38.5/mm
  for (const int k : {0, 1, 10, 40, 70, 74, 80, 119}) {
    FocalStack stack = stack_of(grid, distance, 3);
    Image& image = stack.pictures[0];
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 120; ++i)
        for (int c = 0; c < 3; ++c) image(j, i, c) = float(c + 1 + std::cos(pi * k * (i + 0.5) / 120));
    limit_to_panel(stack, limit_panel, green_light);
    const double frequency = k / (2 * grid.width()), left = std::max(0.0, 1 - frequency / cutoff);
    for (int i = 0; i < 120; ++i)
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(image(1, i, c), c + 1 + left * std::cos(pi * k * (i + 0.5) / 120), 2e-6)
            << k << " floats of up to 4";
  }
}

TEST(DiffractionLimit, NearThePanelItsPixelsAreTheLimit) {
  // At 1 mm, w/(λd) is more than 1/pitch: c = 1/pitch, whose sinc² is 0 at all other pixels of the same pitch.
  FocalStack stack = stack_of({33, 33, 8e-6}, 1e-3);
  stack.pictures[0](10, 20) = 1;
  FocalStack same = stack;
  limit_to_panel(stack, limit_panel, green_light);
  for (size_t i = 0; i < same.pictures[0].values.size(); ++i)
    ASSERT_NEAR(stack.pictures[0].values[i], same.pictures[0].values[i], 1e-6);
  // Pixels of half the pitch see it: sinc²(½) = 4/π² beside the peak, 0 at two pixels.
  FocalStack fine = stack_of({65, 65, 4e-6}, 1e-3);
  fine.pictures[0](32, 32) = 1;
  limit_to_panel(fine, limit_panel, green_light);
  // The reflected pattern is below 4/(π·65)² of the peak.
  EXPECT_NEAR(fine.pictures[0](32, 33) / fine.pictures[0](32, 32), 4 / (pi * pi), 1e-3);
  EXPECT_NEAR(fine.pictures[0](34, 32) / fine.pictures[0](32, 32), 0, 1e-3);
}

TEST(DiffractionLimit, EnergyStaysAndEvenPicturesStayEven) {
  FocalStack stack = stack_of({31, 17, 8e-6}, 0.3, 3);
  for (size_t i = 0; i < stack.pictures[0].values.size(); ++i) stack.pictures[0].values[i] = i % 7 == 0;
  stack.distances.push_back(0.1);
  stack.pictures.emplace_back(17, 31, 3);
  for (float& value : stack.pictures[1].values) value = 0.5;
  const double before = sum_of(stack.pictures[0]);
  limit_to_panel(stack, limit_panel, green_light);
  EXPECT_NEAR(sum_of(stack.pictures[0]), before, 1e-5 * before) << "floats";
  for (const float value : stack.pictures[1].values) ASSERT_NEAR(value, 0.5, 1e-6);
  for (const float value : stack.pictures[0].values) ASSERT_GE(value, 0);
}

TEST(DiffractionLimit, RefusesStacksThatAreNone) {
  const auto error = [](FocalStack stack) {
    return error_of([&] { limit_to_panel(stack, limit_panel, green_light); });
  };
  const FocalStack good = stack_of({4, 3, 8e-6}, 0.3);
  EXPECT_EQ(error(good), "no error");
  FocalStack bad = good;
  bad.distances = {}, bad.pictures = {};
  EXPECT_EQ(error(bad), "expected a focal stack of at least one plane, got none");
  bad = good;
  bad.distances.push_back(0.4);
  EXPECT_EQ(error(bad), "expected a picture for each of the 2 planes of the focal stack, got 1");
  bad = good;
  bad.distances[0] = -0.1;
  EXPECT_EQ(error(bad), "expected a length above 0 m for plane 1 of the focal stack, got -100 mm");
  for (const float value : {-1.0f, std::nanf(""), INFINITY}) {
    bad = good;
    bad.pictures[0](1, 2) = value;
    EXPECT_NE(error(bad).find("expected finite radiance of 0 or more in plane 1 of the focal stack"),
              std::string::npos);
  }
  bad = good;
  bad.pictures[0] = Image(4, 4, 1);
  EXPECT_EQ(error(bad), "expected 4 x 3 pixels and 1 channel(s) in plane 1 of the focal stack, got 4 x 4 and 1");
}

}  // namespace
}  // namespace holotrace
