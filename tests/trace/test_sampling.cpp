#include <gtest/gtest.h>

#include <set>

#include "holotrace/trace/first_hits.h"
#include "holotrace/trace/material.h"
#include "holotrace/trace/sampling.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

// Chi-square statistics as (χ² − k)/√(2k), k in the hundreds: 4 of its standard deviations are p = 6e-5.
constexpr double deviations = 4;

TEST(Sampling, DirectionsOfDiffuseMaterialsFollowTheirPdf) {
  const Vec3 normal = normalize({1, -2, 3});
  const SurfacePoint point{{}, normal, normal, {}, 0};
  const Material material = grey(0.5);
  constexpr int rows = 16, columns = 32, count = 200000, steps = 16;
  std::vector<double> found(rows * columns), expected(rows * columns);
  const Frame frame = frame_from_normal(normal);
  CounterRandom random(1, 0, 0);
  for (int i = 0; i < count; ++i) {
    const Vec3 d = sample_material(material, point, random).direction;
    ASSERT_NEAR(length(d), 1, 1e-14);  // a few roundings
    const double height = dot(d, normal), angle = std::atan2(dot(d, frame.y), dot(d, frame.x));
    const int row = int(height * rows), column = int((angle / (2 * pi) + 0.5) * columns);
    ++found[size_t(std::min(row, rows - 1) * columns + std::min(column, columns - 1))];
  }
  // Midpoint rule over cells of height and angle, whose area is their solid angle; exact for the cosine.
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      for (int i = 0; i < steps; ++i) {
        const double z = (row + (i + 0.5) / steps) / rows, angle = 2 * pi * ((column + 0.5) / columns - 0.5);
        const double s = std::sqrt(1 - z * z);
        const Vec3 d = transform_vector(frame, {s * std::cos(angle), s * std::sin(angle), z});
        expected[size_t(row * columns + column)] +=
            count * pdf_material(material, point, d) * (2 * pi / columns) * (1.0 / rows) / steps;
      }
  double chi_square = 0;
  for (size_t i = 0; i < found.size(); ++i)
    chi_square += (found[i] - expected[i]) * (found[i] - expected[i]) / expected[i];
  const double freedom = rows * columns - 1;
  EXPECT_LT(std::abs(chi_square - freedom) / std::sqrt(2 * freedom), deviations);
}

TEST(Sampling, WeightOfAMaterialSampleIsItsValueOverItsPdf) {
  const Vec3 normal = normalize({0.3, 0.1, 1});
  const SurfacePoint point{{}, normal, normal, {}, 0};
  const Material material = DiffuseMaterial{{0.2, 0.5, 0.9}, nullptr, {}};
  CounterRandom random(2, 0, 0);
  for (int i = 0; i < 100; ++i) {
    const MaterialSample s = sample_material(material, point, random);
    const Vec3 ratio = eval_material(material, point, s.direction) / pdf_material(material, point, s.direction);
    EXPECT_NEAR(length(s.weight - ratio), 0, 1e-14);  // a few roundings
  }
}

TEST(Sampling, DiffuseSurfacesReflectTheirAlbedoAndNothingThroughTheTriangle) {
  const Vec3 normal{0, 0, 1};
  const SurfacePoint point{{}, normal, normal, {}, 0};
  const Material material = grey(0.7);
  // ∫ f cosθ dω by the midpoint rule in height and one angle: exact for the cosine.
  double sum = 0;
  for (int i = 0; i < 64; ++i) {
    const double z = (i + 0.5) / 64;
    sum += eval_material(material, point, {std::sqrt(1 - z * z), 0, z}).x * 2 * pi / 64;
  }
  EXPECT_NEAR(sum, 0.7, 1e-14);
  EXPECT_EQ(eval_material(material, point, {0, 0, -1}), Vec3());
}

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
    EXPECT_NEAR(mean_x, 0.5, 1e-12);  // the cells leave no gap: their centroid is the square's
    EXPECT_NEAR(mean_y, 0.5, 1e-12);
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
  EXPECT_LT(same, 6);  // a Poisson number of mean 1: more than 5 has a chance of 6e-4
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
  // The midpoint rule is off by h²/24 · ∂(first derivative) / area: below 1e-6 for n = 2000 and sides of a few depths.
  const double rectangles[][4] = {{-0.03, 0.03, -0.03, 0.03}, {0.5, 1, -1, -0.25}, {-1, 1, -1, 1}, {-3, 2, 0, 4}};
  for (const auto& r : rectangles) {
    const double slow = wave_power_slowly(1, r[0], r[1], r[2], r[3], 2000);
    EXPECT_NEAR(wave_power(1, r[0], r[1], r[2], r[3]) / slow, 1, 1e-6);
  }
  // Homogeneous of degree 2 in all lengths.
  EXPECT_NEAR(wave_power(0.3, -0.3, 0.6, 0, 0.3) / 0.09, wave_power(1, -1, 2, 0, 1), 1e-12);
}

TEST(Sampling, PowerOfAWaveKeepsItsAccuracyOnPanelsMuchWiderThanItsDepth) {
  // Sum over narrow strips, for each of which the rule is exact to rounding.
  for (double half : {1.0, 30.0}) {
    double strips = 0;
    for (int i = 0; i < 1000; ++i)
      strips += wave_power(1, half * (i / 500.0 - 1), half * ((i + 1) / 500.0 - 1), -half, half);
    EXPECT_NEAR(wave_power(1, -half, half, -half, half) / strips, 1, half > 1 ? 1e-5 : 1e-9);  // as the header says
  }
}

}  // namespace
}  // namespace holotrace
