#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "holotrace/trace/geometry/first_hits.h"
#include "holotrace/trace/shared/sampling.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

TEST(Sampling, StrataTileTheSquareInCellsOfEqualArea) {
  for (int64_t count : {1, 2, 3, 7, 10, 64, 1000}) {
    double area = 0, mean_x = 0, mean_y = 0;
    for (int64_t i = 0; i < count; ++i) {
      const Vec2 low = stratum(i, count, 0, 0), high = stratum(i, count, 1, 1);
      const double cell = (high.x - low.x) * (high.y - low.y);
      EXPECT_NEAR(cell * double(count), 1, 1e-12) << i << " of " << count;
      area += cell;
      mean_x += cell * (low.x + high.x) / 2;
      mean_y += cell * (low.y + high.y) / 2;
    }
    EXPECT_NEAR(area, 1, 1e-12);
    EXPECT_NEAR(mean_x, 0.5, 1e-12);  // the cells leave no gap: their centroid is that of the square
    EXPECT_NEAR(mean_y, 0.5, 1e-12);
  }
}

TEST(Sampling, PointsOnACircleAreItsCosineAndSine) {
  constexpr long double turn = 2 * std::numbers::pi_v<long double>;
  for (int i = 0; i <= 4096; ++i) {  // with the ends and the middles of all octants
    const double t = i < 4096 ? i / 4096. : std::nextafter(1., 0.);
    const Vec2 place = point_on_circle(t);
    // The first term that is left out, (π/4)¹⁶/16! = 1e-15, and some rounding of numbers up to 1.
    EXPECT_NEAR(place.x, double(std::cos(turn * t)), 2e-15) << t;
    EXPECT_NEAR(place.y, double(std::sin(turn * t)), 2e-15) << t;
  }
}

TEST(Sampling, APermutationTakesEveryPlaceOnceAndDependsOnTheSeed) {
  for (int64_t count : {1, 2, 5, 64, 1000}) {
    const Permutation permutation(count, CounterRandom(1, 0, 0));
    std::set<int64_t> places;
    for (int64_t i = 0; i < count; ++i) places.insert(permutation(i));
    EXPECT_EQ(int64_t(places.size()), count);
    EXPECT_EQ(*places.begin(), 0);
    EXPECT_EQ(*places.rbegin(), count - 1);
  }
  const Permutation a(1000, CounterRandom(1, 0, 0)), b(1000, CounterRandom(2, 0, 0));
  int same = 0;
  for (int64_t i = 0; i < 1000; ++i) same += a(i) == b(i);
  EXPECT_LT(same, 6);  // a Poisson number of mean 1: more than 5 with probability 6e-4
}

/// The same integral by the midpoint rule, n × n.
double wave_power_slowly(double d, double x0, double x1, double y0, double y1, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double x = x0 + (x1 - x0) * (i + 0.5) / n, y = y0 + (y1 - y0) * (j + 0.5) / n;
      sum += d * d / (d * d + x * x + y * y);
    }
  return sum * (x1 - x0) * (y1 - y0) / n / n;
}

TEST(Sampling, PowerOfAWaveOnARectangleIsItsIntegral) {
  // The midpoint rule has an error of h²/24 · ∂(first derivative)/area: < 1e-6 for n = 2000 and sides of a few depths.
  const double rectangles[][4] = {{-0.03, 0.03, -0.03, 0.03}, {0.5, 1, -1, -0.25}, {-1, 1, -1, 1}, {-3, 2, 0, 4}};
  for (const auto& r : rectangles) {
    const double slow = wave_power_slowly(1, r[0], r[1], r[2], r[3], 2000);
    EXPECT_NEAR(wave_power(1, r[0], r[1], r[2], r[3]) / slow, 1, 1e-6);
  }
  // Homogeneous of degree 2 in all lengths.
  EXPECT_NEAR(wave_power(0.3, -0.3, 0.6, 0, 0.3) / 0.09, wave_power(1, -1, 2, 0, 1), 1e-12);
}

TEST(Sampling, PowerOfAWaveKeepsItsAccuracyOnPanelsMuchWiderThanItsDepth) {
  // Sum over narrow strips, for which the rule is exact to rounding.
  for (double half : {1.0, 30.0}) {
    double strips = 0;
    for (int i = 0; i < 1000; ++i)
      strips += wave_power(1, half * (i / 500.0 - 1), half * ((i + 1) / 500.0 - 1), -half, half);
    EXPECT_NEAR(wave_power(1, -half, half, -half, half) / strips, 1, half > 1 ? 1e-5 : 1e-9);  // as the header says
  }
}

}  // namespace
}  // namespace holotrace
