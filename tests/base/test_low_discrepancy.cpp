#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "holotrace/base/low_discrepancy.h"
#include "holotrace/base/units.h"
#include "support/statistics.h"

namespace holotrace {
namespace {

constexpr uint64_t seeds[] = {0, 1, 2, 42, 0xffffffffffffffff};

/// Dimension `pair` of points first … first + count − 1 of a sequence.
std::vector<Vec2> points(LowDiscrepancy sequence, int pair, uint32_t count, uint32_t first = 0) {
  std::vector<Vec2> result;
  for (uint32_t i = 0; i < count; ++i) {
    sequence.start(first + i);
    for (int skipped = 0; skipped < pair; ++skipped) sequence.two();
    result.push_back(sequence.two());
  }
  return result;
}

/// Whether exactly one of 2ᵐ points is in each of the 2ᵃ × 2ᵐ⁻ᵃ boxes of equal area, for every a.
bool is_net(const std::vector<Vec2>& points, int m) {
  for (int a = 0; a <= m; ++a) {
    std::vector<bool> taken(size_t(1) << m);
    for (Vec2 p : points) {
      const auto box = size_t(p.x * (1 << a)) << (m - a) | size_t(p.y * (1 << (m - a)));
      if (taken[box]) return false;
      taken[box] = true;
    }
  }
  return true;
}

TEST(LowDiscrepancy, TheFirstPointsOfAPairAreANet) {
  for (uint64_t seed : seeds)
    for (int pair = 0; pair < 4; ++pair)
      for (int m = 0; m <= 10; ++m)
        ASSERT_TRUE(is_net(points(LowDiscrepancy(seed, 3, 7), pair, 1u << m), m))
            << "seed " << seed << ", pair " << pair << ", 2^" << m << " points";
}

TEST(LowDiscrepancy, EveryAlignedBlockOfSixteenOrMorePointsIsANet) {
  for (uint64_t seed : seeds)
    for (int m = 4; m <= 10; ++m)
      for (uint32_t block : {1u, 6u, (1u << (32 - m)) - 1u})
        ASSERT_TRUE(is_net(points(LowDiscrepancy(seed, 3, 7), 0, 1u << m, block << m), m))
            << "seed " << seed << ", 2^" << m << " points, block " << block;
}

TEST(LowDiscrepancy, TheFirstPointsOfASingleDimensionAreStratified) {
  for (uint64_t seed : seeds)
    for (int m = 0; m <= 10; ++m) {
      LowDiscrepancy sequence(seed, 0, 5);
      std::vector<bool> taken(size_t(1) << m);
      for (uint32_t i = 0; i < 1u << m; ++i) {
        sequence.start(i);
        sequence.two();
        const auto cell = size_t(sequence.one() * (1 << m));
        ASSERT_FALSE(taken[cell]) << "seed " << seed << ", 2^" << m << " points";
        taken[cell] = true;
      }
    }
}

TEST(LowDiscrepancy, TheOrderOfPathsDoesNotMatter) {
  constexpr uint32_t count = 64;
  const std::vector<Vec2> forward = points(LowDiscrepancy(1, 2, 3), 1, count);
  LowDiscrepancy sequence(1, 2, 3);
  for (uint32_t i = count; i-- > 0;) {
    sequence.start(i);
    sequence.one();  // a path may end anywhere; a dimension, single or pair, is a position in the path
    EXPECT_EQ(sequence.two(), forward[i]);
  }
}

TEST(LowDiscrepancy, ABlockHasTheNumbersOfItsPaths) {
  for (const uint32_t block : {0U, 1U, 5U, 100000U})
    for (const int dimension : {0, 1, 7, 31, 40}) {
      LowDiscrepancy sequence(3, 1, 4);
      sequence.start(77);  // where the sequence stands does not matter
      const LowDiscrepancy::Block numbers = sequence.two_of_block(block, dimension);
      for (uint32_t i = 0; i < 16; ++i) {
        LowDiscrepancy alone(3, 1, 4);  // the first path of a block is computed by itself
        alone.start(16 * block + i);
        alone.skip(dimension);
        EXPECT_EQ(alone.two(), (Vec2{numbers.x[i] * 0x1p-32, numbers.y[i] * 0x1p-32})) << block << ", path " << i;
      }
      sequence.start(16 * block + 9);
      for (int times = 0; times < 2; ++times) {  // computed, then kept
        EXPECT_EQ(sequence.of_block(dimension).x, numbers.x);
        EXPECT_EQ(sequence.of_block(dimension).y, numbers.y);
      }
      sequence.go_to(5, dimension);
      EXPECT_EQ(sequence.dimension(), dimension);
      EXPECT_EQ(sequence.two(), (Vec2{numbers.x[5] * 0x1p-32, numbers.y[5] * 0x1p-32}));
      sequence.start(16 * block);
      for (int left = 0; left < dimension; ++left) left % 2 ? sequence.one() : sequence.two().x;
      EXPECT_EQ(sequence.two().x, numbers.x[0] * 0x1p-32) << "a dimension is one() or two()";
    }
}

TEST(LowDiscrepancy, NumbersKeptForABlockAreThoseOfEachPathAlone) {
  // More dimensions than are kept, in an order in which paths of two blocks alternate, then follow each other.
  LowDiscrepancy together(9, 0, 2);
  for (const uint32_t path : {3U, 20U, 4U, 3U, 15U, 0U, 16U, 31U, 17U, 20U}) {
    together.start(path);
    LowDiscrepancy alone(9, 0, 2);
    alone.start(path);
    for (int dimension = 0; dimension < 40; ++dimension) {
      if (dimension % 3 == 1)
        EXPECT_EQ(together.one(), alone.one()) << path << ", dimension " << dimension;
      else
        EXPECT_EQ(together.two(), alone.two()) << path << ", dimension " << dimension;
    }
  }
}

TEST(LowDiscrepancy, ANewSequenceStartsAtPathZero) {
  LowDiscrepancy fresh(1, 2, 3), started(1, 2, 3);
  started.start(9);
  started.two();
  started.start(0);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(fresh.two(), started.two());
}

// Each run of `count` paths, across blocks, has each stratum once; the first path of a sample has each as often.
TEST(LowDiscrepancy, PathsTakeStrataInTurnFromARandomOneOn) {
  std::array<int, 3> of_first{};
  for (uint64_t sample = 0; sample < 3000; ++sample) {
    LowDiscrepancy sequence(1, 0, sample);
    sequence.start(0);
    const int first = sequence.stratum(3);
    ++of_first[size_t(first)];
    for (uint32_t path = 0; path < 40; ++path) {
      sequence.start(path);
      EXPECT_EQ(sequence.stratum(3), (first + int(path)) % 3) << path;
    }
    EXPECT_EQ(sequence.dimension(), 0);
  }
  for (const int count : of_first) EXPECT_NEAR(count, 1000, 4 * std::sqrt(3000 * 2.0 / 9)) << "4 standard deviations";
}

TEST(LowDiscrepancy, SeedFrameSampleAndPathEachChangeTheNumbers) {
  const Vec2 first = LowDiscrepancy(1, 0, 0).two();
  EXPECT_NE(first, LowDiscrepancy(2, 0, 0).two());
  EXPECT_NE(first, LowDiscrepancy(1ull << 32 | 1, 0, 0).two());
  EXPECT_NE(first, LowDiscrepancy(1, 1, 0).two());
  EXPECT_NE(first, LowDiscrepancy(1, 0, 1).two());
  EXPECT_NE(first, LowDiscrepancy(1, 0, 1ull << 32).two());
  LowDiscrepancy next(1, 0, 0);
  next.start(1);
  EXPECT_NE(first, next.two());
}

TEST(LowDiscrepancy, OnePathOfManySamplesIsUniform) {
  // Paths 0 and 1, one in the middle and the last. A scramble with few random bits would show at path 0.
  for (uint32_t path : {0u, 1u, 1000u, 0xffffffffu})
    for (int pair : {0, 5}) {
      constexpr int per_cell = 100;
      std::vector<int> square(32 * 32), single(1024), fine(1024);
      for (uint64_t sample = 0; sample < per_cell * 1024; ++sample) {
        LowDiscrepancy sequence(1, 0, sample);
        sequence.start(path);
        for (int skipped = 0; skipped < pair; ++skipped) sequence.two();
        const Vec2 p = sequence.two();
        const double u = sequence.one();
        for (double v : {p.x, p.y, u}) ASSERT_TRUE(v >= 0 && v < 1) << v;
        ++square[size_t(p.x * 32) * 32 + size_t(p.y * 32)];
        ++single[size_t(u * 1024)];
        ++fine[size_t(p.x * 0x1p20) % 1024];  // binary digits 11 … 20 of x
      }
      EXPECT_LT(std::abs(chi_square_z(square, per_cell)), deviations) << "two(), path " << path << ", pair " << pair;
      EXPECT_LT(std::abs(chi_square_z(single, per_cell)), deviations) << "one(), path " << path << ", pair " << pair;
      EXPECT_LT(std::abs(chi_square_z(fine, per_cell)), deviations) << "digits, path " << path << ", pair " << pair;
    }
}

TEST(LowDiscrepancy, TwoPathsOfASampleAreDistributedAsInAnOwenScramble) {
  // Points 0 and 1 lie in different halves of the interval. Beyond the first binary digit their digits are
  // independent in an Owen scramble: 16 × 16 cells of the digits 2 to 5 of the two points.
  constexpr int per_cell = 400;
  std::vector<int> counts(256);
  for (uint64_t sample = 0; sample < per_cell * 256; ++sample) {
    const std::vector<Vec2> p = points(LowDiscrepancy(1, 0, sample), 0, 2);
    ASSERT_NE(p[0].x < 0.5, p[1].x < 0.5);
    ++counts[size_t(p[0].x * 32) % 16 * 16 + size_t(p[1].x * 32) % 16];
  }
  EXPECT_LT(std::abs(chi_square_z(counts, per_cell)), deviations);
}

/// Variance of the mean of (u − ½)(v − ½) over many paths, for two dimensions of different pairs or samples, relative
/// to that of independent numbers: 1 + 15·(1/15)². Each dimension has one point of a block of 16 in each sixteenth, so
/// two points of a block have the correlation −1/15 in u and in v, and 1/225 in the product; blocks add almost
/// nothing.
constexpr double product_variance = 1 + 1.0 / 15;

/// √(144·N) times the mean of (u − ½)(v − ½): for independent u and v about normal, with variance 1.
double correlation_z(const std::vector<double>& u, const std::vector<double>& v) {
  double sum = 0;
  for (size_t i = 0; i < u.size(); ++i) sum += (u[i] - 0.5) * (v[i] - 0.5);
  return 12 * sum / std::sqrt(double(u.size()));
}

TEST(LowDiscrepancy, DimensionsOfAPathAreUncorrelated) {
  // The numbers of path 0 … 1023 in eight pairs, which are sixteen dimensions, of 50 samples. Within a pair the net
  // itself lowers the correlation, so only dimensions of different pairs are compared.
  constexpr uint32_t count = 1024;
  constexpr int samples = 50, pairs = 8;
  double sum = 0, squares = 0, largest = 0;
  int compared = 0;
  for (uint64_t sample = 0; sample < samples; ++sample) {
    std::vector<std::vector<double>> dimension(2 * pairs);
    LowDiscrepancy sequence(1, 0, sample);
    for (uint32_t i = 0; i < count; ++i) {
      sequence.start(i);
      for (size_t pair = 0; pair < pairs; ++pair) {
        const Vec2 p = sequence.two();
        dimension[2 * pair].push_back(p.x);
        dimension[2 * pair + 1].push_back(p.y);
      }
    }
    for (size_t a = 0; a < dimension.size(); ++a)
      for (size_t b = a / 2 * 2 + 2; b < dimension.size(); ++b, ++compared) {
        const double z = correlation_z(dimension[a], dimension[b]);
        sum += z;
        squares += z * z;
        largest = std::max(largest, std::abs(z));
      }
  }
  EXPECT_LT(std::abs(sum), deviations * std::sqrt(compared));
  // z² has mean v and variance 2v² for a normal z of variance v.
  EXPECT_LT(std::abs(squares / product_variance - compared), deviations * std::sqrt(2.0 * compared));
  // 5600 comparisons with p = 6e-5 for all together: 5.7 standard deviations each (Šidák), of √product_variance.
  EXPECT_LT(largest, 5.7 * std::sqrt(product_variance));
}

TEST(LowDiscrepancy, NeighbouringSamplesFramesAndSeedsAreUncorrelated) {
  constexpr uint32_t count = 1024;
  const auto x_of = [&](LowDiscrepancy sequence) {
    std::vector<double> x;
    for (Vec2 p : points(sequence, 0, count)) x.push_back(p.x);
    return x;
  };
  constexpr int compared = 300;
  double sums[3] = {}, squares[3] = {};
  for (uint32_t i = 0; i < compared; ++i) {
    const std::vector<double> here = x_of(LowDiscrepancy(i, i, i));
    const LowDiscrepancy neighbours[] = {{i, i, i + 1}, {i, i + 1, i}, {i + 1, i, i}};
    for (int n = 0; n < 3; ++n) {
      const double z = correlation_z(here, x_of(neighbours[n]));
      sums[n] += z;
      squares[n] += z * z;
    }
  }
  for (int n = 0; n < 3; ++n) {
    EXPECT_LT(std::abs(sums[n]), deviations * std::sqrt(compared)) << n;
    EXPECT_LT(std::abs(squares[n] / product_variance - compared), deviations * std::sqrt(2.0 * compared)) << n;
  }
}

/// A smooth integrand over one pair of dimensions, and its integral over the unit square.
struct Integrand {
  const char* name;
  double (*value)(Vec2);
  double integral;
};

const Integrand smooth[] = {
    {"x y", [](Vec2 p) { return p.x * p.y; }, 0.25},
    {"exp(x + y)", [](Vec2 p) { return std::exp(p.x + p.y); }, (std::exp(1.0) - 1) * (std::exp(1.0) - 1)},
    {"sin(pi x) y^2", [](Vec2 p) { return std::sin(pi * p.x) * p.y * p.y; }, 2 / (3 * pi)},
    {"1/(1 + x + 2 y)", [](Vec2 p) { return 1 / (1 + p.x + 2 * p.y); },
     // ∫∫ = ½[F(4) − F(3) − F(2) + F(1)], F(t) = t·ln t
     0.5 * (4 * std::log(4.0) - 3 * std::log(3.0) - 2 * std::log(2.0))},
};

/// Root mean square error of the mean of `count` points, over 256 samples.
double error_of(const Integrand& integrand, uint32_t count) {
  constexpr int samples = 256;
  double squares = 0;
  for (uint64_t sample = 0; sample < samples; ++sample) {
    double sum = 0;
    for (Vec2 p : points(LowDiscrepancy(3, 0, sample), 0, count)) sum += integrand.value(p);
    squares += std::pow(sum / count - integrand.integral, 2);
  }
  return std::sqrt(squares / samples);
}

TEST(LowDiscrepancy, ErrorsOfSmoothIntegrandsFallFasterThanWithIndependentNumbers) {
  // Owen (1997): N^(−3/2)·√log N for s = 2 and smooth integrands. From 16 to 1024 points this is a slope of
  // −1.5 + ½·log(log 1024/log 16)/log 64 = −1.39; for independent numbers −0.5. The root mean square of
  // 256 samples has an error of 1/√512 = 4 %, the slope between two of them 0.014: −1.25 leaves a margin.
  for (const Integrand& integrand : smooth) {
    const double slope = std::log(error_of(integrand, 1024) / error_of(integrand, 16)) / std::log(64.0);
    EXPECT_LT(slope, -1.25) << integrand.name;
  }
}

TEST(LowDiscrepancy, SumsOverPairsKeepTheRateAndProductsAreAboutAsWithIndependentNumbers) {
  constexpr int samples = 4096;
  constexpr uint32_t count = 256;
  double of_sum = 0, of_product = 0;
  for (uint64_t sample = 0; sample < samples; ++sample) {
    LowDiscrepancy sequence(4, 0, sample);
    double sum = 0, product = 0;
    for (uint32_t i = 0; i < count; ++i) {
      sequence.start(i);
      const Vec2 a = sequence.two(), b = sequence.two();
      sum += std::exp(a.x + a.y) + std::exp(b.x + b.y);
      product += (a.x - 0.5) * (b.x - 0.5);
    }
    of_sum += std::pow(sum / count - 2 * std::pow(std::exp(1.0) - 1, 2), 2);
    of_product += std::pow(product / count, 2);
  }
  const double e = std::exp(1.0), variance = std::pow((e * e - 1) / 2, 2) - std::pow(e - 1, 4);
  // The net lowers the variance by about N²/log N, here above 10⁴; the test asks for a factor of 100.
  EXPECT_LT(of_sum / samples, 0.01 * 2 * variance / count);
  // The variance of a normal number from 4096 samples has an error of √(2/4096).
  EXPECT_NEAR(of_product / samples * 144 * count, product_variance, deviations * std::sqrt(2.0 / samples));
}

TEST(LowDiscrepancy, MeansAreUnbiasedForAnyNumberOfPaths) {
  // Over many samples the mean error is normal, with a standard error estimated from the errors themselves.
  for (const Integrand& integrand : smooth)
    for (uint32_t count : {1u, 3u, 16u, 100u}) {
      constexpr int samples = 4096;
      double sum = 0, squares = 0;
      for (uint64_t sample = 0; sample < samples; ++sample) {
        double total = 0;
        for (Vec2 p : points(LowDiscrepancy(5, 1, sample), 2, count)) total += integrand.value(p);
        const double error = total / count - integrand.integral;
        sum += error;
        squares += error * error;
      }
      EXPECT_LT(std::abs(sum), deviations * std::sqrt(squares)) << integrand.name << ", " << count << " paths";
    }
}

}  // namespace
}  // namespace holotrace
