#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "holotrace/base/random.h"
#include "support/statistics.h"

namespace holotrace {
namespace {

TEST(CounterRandom, IsPhilox4x32WithTheKnownAnswerOfItsAuthors) {
  // Random123 kat_vectors: philox4x32 10, counter 0, key 0 → 6627e8d5 e169c58d bc57ac4c 9b00dbd8.
  CounterRandom random(0, 0, 0);
  for (double expected : {0x6627e8d5.0p-32, 0xe169c58d.0p-32, 0xbc57ac4c.0p-32, 0x9b00dbd8.0p-32})
    EXPECT_EQ(random.uniform(), expected);
}

TEST(CounterRandom, SameKeyGivesTheSameSequence) {
  CounterRandom a(7, 3, 11), b(7, 3, 11);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(a.uniform(), b.uniform());
}

TEST(CounterRandom, SeedFrameAndSampleEachChangeTheSequence) {
  const double first = CounterRandom(1, 0, 0).uniform();
  EXPECT_NE(first, CounterRandom(2, 0, 0).uniform());
  EXPECT_NE(first, CounterRandom(1ull << 32 | 1, 0, 0).uniform());
  EXPECT_NE(first, CounterRandom(1, 1, 0).uniform());
  EXPECT_NE(first, CounterRandom(1, 0, 1).uniform());
  EXPECT_NE(first, CounterRandom(1, 0, 1ull << 32).uniform());
}

TEST(CounterRandom, OneSequenceIsUniformInPairs) {
  std::vector<int> counts(32 * 32);
  CounterRandom random(1, 0, 0);
  constexpr int per_cell = 100;
  for (int i = 0; i < per_cell * 32 * 32; ++i) {
    const int row = int(random.uniform() * 32), column = int(random.uniform() * 32);
    ++counts[size_t(row * 32 + column)];
  }
  EXPECT_LT(std::abs(chi_square_z(counts, per_cell)), deviations);
}

TEST(CounterRandom, FirstNumbersOfNeighbouringSamplesAreUniformAndUncorrelated) {
  std::vector<int> counts(1024);
  constexpr int per_cell = 100, count = per_cell * 1024;
  double product = 0, previous = 0;
  for (int i = 0; i < count; ++i) {
    const double u = CounterRandom(1, 0, uint64_t(i)).uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    ++counts[size_t(u * 1024)];
    product += (u - 0.5) * (previous - 0.5);
    previous = u;
  }
  EXPECT_LT(std::abs(chi_square_z(counts, per_cell)), deviations);
  // Each product has mean 0 and variance 1/144.
  EXPECT_LT(std::abs(product), deviations * std::sqrt(count / 144.0));
}

}  // namespace
}  // namespace holotrace
