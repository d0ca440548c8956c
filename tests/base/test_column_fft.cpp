#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/column_fft.h"
#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/random.h"

namespace holotrace {
namespace {

constexpr int columns = column_block;
constexpr long double turn = 2 * std::numbers::pi_v<long double>;

template <class Real>
class ColumnTransforms : public ::testing::Test {
 protected:
  using Complex = std::complex<Real>;

  static AlignedVector<Complex> noise(int length) {
    AlignedVector<Complex> data;
    CounterRandom random(17, 0, 0);
    for (int i = 0; i < length * columns; ++i)
      data.emplace_back(Real(random.uniform() - 0.5), Real(random.uniform() - 0.5));
    return data;
  }

  // Sample k of the transform of each column, by the definition. In double its own rounding would be the larger one.
  static std::array<std::complex<long double>, columns> slow(const AlignedVector<Complex>& data, int length, int k,
                                                             int sign) {
    std::array<std::complex<long double>, columns> sums{};
    for (int i = 0; i < length; ++i) {
      const auto root = std::polar(1.0L, sign * turn * (int64_t(k) * i % length) / length);
      for (int c = 0; c < columns; ++c)
        sums[size_t(c)] += std::complex<long double>(data[size_t(i * columns + c)]) * root;
    }
    return sums;
  }

  // Compares `samples` of the spectrum with the definition. They are about √(length/6). Each of its log₂(length) levels
  // rounds them by an epsilon or less, at random, by sums, products and factors: together 0.4·√(length·levels) epsilons
  // as a standard deviation. Five times that is beyond chance.
  static void expect_the_definition(int length, int samples) {
    const auto data = noise(length);
    AlignedVector<Complex> out(data.size()), work(data.size());
    const ColumnFft<Real> transform(length);
    const long double tolerance =
        2 * std::numeric_limits<Real>::epsilon() * std::sqrt(length * (1 + std::log2(length)));
    for (const auto& [direction, sign] : {std::pair{FftDirection::forward, -1}, {FftDirection::backward, 1}}) {
      transform(direction, data.data(), out.data(), work.data());
      for (int n = 0; n < samples; ++n) {
        const int k = int(int64_t(n) * length / samples);
        const auto expected = slow(data, length, k, sign);
        for (int c = 0; c < columns; ++c) {
          const std::complex<long double> got(out[size_t(k * columns + c)]);
          ASSERT_LT(std::abs(got - expected[size_t(c)]), tolerance)
              << "sample " << k << " of " << length << ", column " << c << ", sign " << sign;
        }
      }
    }
    EXPECT_EQ(data, noise(length)) << "the input is not changed";
  }
};

using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(ColumnTransforms, Reals);

// Lengths of one stage, of several, and those with other factors than 2 to 13 (17, 19, …).
TYPED_TEST(ColumnTransforms, AreTheDefinitionForAllShortLengths) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    for (int length = 1; length <= 100; ++length) TestFixture::expect_the_definition(length, length);
  }
}

// Panels of 1080 and 2160 rows; powers of each radix alone; prime numbers.
TYPED_TEST(ColumnTransforms, AreTheDefinitionForPanels) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    for (const int length : {1080, 1087, 1152, 1331, 2160, 2187, 2197, 2401, 2716, 3125, 3600, 4096, 4320})
      TestFixture::expect_the_definition(length, 7);
  }
}

TYPED_TEST(ColumnTransforms, GoBackToWhatTheyCameFrom) {
  const int length = 1080;
  const auto data = this->noise(length);
  AlignedVector<std::complex<TypeParam>> spectrum(data.size()), back(data.size()), work(data.size());
  const ColumnFft<TypeParam> transform(length);
  transform(FftDirection::forward, data.data(), spectrum.data(), work.data());
  transform(FftDirection::backward, spectrum.data(), back.data(), work.data());
  // Both ways round by about √log₂(length) half epsilons of numbers below 1.
  for (size_t i = 0; i < data.size(); ++i)
    ASSERT_LT(std::abs(back[i] / TypeParam(length) - data[i]), 20 * std::numeric_limits<TypeParam>::epsilon()) << i;
}

// Any thread may use any of them at any time: the result does not depend on what `work` held.
TYPED_TEST(ColumnTransforms, DoNotDependOnTheirWorkSpace) {
  for (const int length : {6, 60, 1080, 1087}) {
    const auto data = this->noise(length);
    AlignedVector<std::complex<TypeParam>> first(data.size()), second(data.size()), work(data.size());
    const ColumnFft<TypeParam> transform(length);
    ASSERT_EQ(transform.work_size(), work.size());
    transform(FftDirection::forward, data.data(), first.data(), work.data());
    work.assign(work.size(), std::numeric_limits<TypeParam>::quiet_NaN());
    second = work;
    transform(FftDirection::forward, data.data(), second.data(), work.data());
    EXPECT_EQ(first, second) << length;
  }
}

TYPED_TEST(ColumnTransforms, TurnColumnsToRows) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    for (const int length : {1, 3, 8, 29}) {
      const auto data = this->noise(length);  // [column][sample]
      std::array<const std::complex<TypeParam>*, columns> from;
      for (size_t c = 0; c < from.size(); ++c) from[c] = data.data() + c * size_t(length);
      AlignedVector<std::complex<TypeParam>> rows(data.size() + 1, TypeParam(7));
      turn_to_rows(from, length, rows.data());
      for (int i = 0; i < length; ++i)
        for (int c = 0; c < columns; ++c)
          ASSERT_EQ(rows[size_t(i * columns + c)], data[size_t(c * length + i)]) << name << ", " << length;
      EXPECT_EQ(rows.back(), std::complex<TypeParam>(7)) << "nothing is written beyond";
    }
  }
}

TEST(ColumnTransform, NeedsASample) {
  try {
    ColumnFft<float>(0);
    FAIL() << "expected an error";
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "expected a transform of at least 1 sample, got 0");
  }
}

}  // namespace
}  // namespace holotrace
