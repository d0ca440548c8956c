#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/column_fft.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/fft_stages.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"

// Transforms of lines, and of columns side by side.

namespace holotrace {
namespace {

constexpr int columns = column_block;
constexpr long double full_turn = 2 * std::numbers::pi_v<long double>;
using LongComplex = std::complex<long double>;

constexpr std::array<std::pair<FftDirection, int>, 2> directions{
    {{FftDirection::forward, -1}, {FftDirection::backward, 1}}};

template <class Real>
AlignedVector<std::complex<Real>> noise(int count) {
  AlignedVector<std::complex<Real>> data;
  CounterRandom random(17, 0, 0);
  for (int i = 0; i < count; ++i) data.emplace_back(Real(random.uniform() - 0.5), Real(random.uniform() - 0.5));
  return data;
}

// Compares `samples` of a spectrum with the definition: transforms of `length` samples, sample i of transform c at
// i·count + c. They are about √(length/6). Each of their log₂(length) levels rounds them by an epsilon or less, at random, by
// sums, products and factors: together 0.4·√(length·levels) epsilons as a standard deviation. Five times that is beyond
// chance; a convolution with a chirp has twice as many levels, and 3.5 times its deviation. The sum is in long double: in
// double its own rounding would be the larger one.
template <class Real>
void expect_the_definition(const AlignedVector<std::complex<Real>>& data, const AlignedVector<std::complex<Real>>& out,
                           int length, int count, int sign, int samples) {
  const long double tolerance =
      2 * std::numeric_limits<Real>::epsilon() * std::sqrt(length * (1 + std::log2((long double)length)));
  std::vector<LongComplex> roots;
  for (int i = 0; i < length; ++i) roots.push_back(std::polar(1.0L, sign * full_turn * i / length));
  for (int n = 0; n < samples; ++n) {
    const int64_t k = int64_t(n) * length / samples;
    for (int c = 0; c < count; ++c) {
      LongComplex sum;
      for (int64_t i = 0; i < length; ++i)
        sum += LongComplex(data[size_t(i * count + c)]) * roots[size_t(k * i % length)];
      ASSERT_LT(std::abs(LongComplex(out[size_t(k * count + c)]) - sum), tolerance)
          << "sample " << k << " of " << length << ", transform " << c << ", sign " << sign;
    }
  }
}

template <class Real>
class Transforms : public ::testing::Test {
 protected:
  using Complex = std::complex<Real>;

  // Both ways, also in place.
  static void expect_lines(int length, int samples) {
    const auto data = noise<Real>(length);
    for (const auto& [direction, sign] : directions) {
      const Fft<Real> transform(length, direction);
      AlignedVector<Complex> out(data.size()), in_place = data;
      transform(data.data(), out.data());
      expect_the_definition(data, out, length, 1, sign, samples);
      transform(in_place.data());
      EXPECT_EQ(in_place, out) << length;
    }
    EXPECT_EQ(data, noise<Real>(length)) << "the input is not changed";
  }

  static void expect_columns(int length, int samples) {
    const auto data = noise<Real>(length * columns);
    const ColumnFft<Real> transform(length);
    AlignedVector<Complex> out(data.size()), work(data.size());
    for (const auto& [direction, sign] : directions) {
      transform(direction, data.data(), out.data(), work.data());
      expect_the_definition(data, out, length, columns, sign, samples);
    }
    EXPECT_EQ(data, noise<Real>(length * columns)) << "the input is not changed";
  }
};

using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Transforms, Reals);

// Lengths of one stage, of several, and those with other factors than 2 to 13 (17, 19, …).
TYPED_TEST(Transforms, AreTheDefinitionForAllShortLengths) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    for (int length = 1; length <= 100; ++length) {
      TestFixture::expect_lines(length, length);
      TestFixture::expect_columns(length, length);
    }
  }
}

// Rows and columns of panels: whole blocks of columns and parts of them; powers of each radix alone; prime numbers (683·2,
// 97·28, 1087).
TYPED_TEST(Transforms, AreTheDefinitionForPanels) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    for (const int length :
         {1001, 1024, 1050, 1080, 1087, 1280, 1331, 1366, 1920, 2160, 2187, 2197, 2401, 2716, 3125, 4096, 4099}) {
      TestFixture::expect_lines(length, 7);
      TestFixture::expect_columns(length, 3);
    }
  }
}

// Within an epsilon (two roundings of an angle up to π/4, one of each part) for any length.
TEST(RootOfUnity, IsExact) {
  for (const int64_t n : {1, 2, 3, 8, 12, 1000, 1087, 1 << 20})
    for (int64_t k = 0; k < n; k += 1 + n / 1000) {
      const std::complex<long double> exact = std::polar(1.0L, -full_turn * (long double)k / (long double)n);
      ASSERT_LT(std::abs(std::complex<long double>(root_of_unity(k, n)) - exact), 2.2e-16L) << k << " of " << n;
    }
}

TYPED_TEST(Transforms, TakeLinesThatAreNotAligned) {
  for (const int n : {6, 60, 250, 1280, 1366}) {
    const auto data = noise<TypeParam>(n + 1);
    AlignedVector<std::complex<TypeParam>> aligned(data.begin() + 1, data.end()), expected(aligned.size()),
        out(data.size());
    const Fft<TypeParam> transform(n, FftDirection::forward);
    transform(aligned.data(), expected.data());
    transform(data.data() + 1, out.data() + 1);
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), out.begin() + 1)) << n;
  }
}

// The result of one thread does not depend on what it transformed before: its memory is used again.
TYPED_TEST(Transforms, DoNotDependOnEarlierOnes) {
  const auto data = noise<TypeParam>(1366);
  AlignedVector<std::complex<TypeParam>> first(data.size()), second(data.size());
  const Fft<TypeParam> transform(1366, FftDirection::forward);
  transform(data.data(), first.data());
  AlignedVector<std::complex<TypeParam>> nothing(4096, std::numeric_limits<TypeParam>::quiet_NaN());
  for (const int n : {4096, 2880, 1280, 17}) Fft<TypeParam>(n, FftDirection::backward)(nothing.data());
  transform(data.data(), second.data());
  EXPECT_EQ(first, second);
}

// 20 columns are a block and a part of one.
TEST(Fft, TransformsRowsAndColumns) {
  const int ny = 9, nx = 20;
  auto data = noise<double>(ny * nx);
  const auto original = data;
  fft_2d(data.data(), ny, nx, FftDirection::forward);
  std::complex<double> expected = 0;  // one coefficient, (3, 5), by the definition
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      expected += original[size_t(j * nx + i)] * std::polar(1.0, -2 * pi * (3.0 * j / ny + 5.0 * i / nx));
  EXPECT_LT(std::abs(data[3 * nx + 5] - expected), 1e-13);
  fft_2d(data.data(), ny, nx, FftDirection::backward);
  for (size_t i = 0; i < data.size(); ++i) EXPECT_LT(std::abs(data[i] / double(ny * nx) - original[i]), 1e-15);
}

TEST(Fft, HasGoodLengthsOfSmallFactors) {
  for (int n = 1; n < 9000; ++n) {
    const int length = fft_good_length(n);
    int rest = length;
    for (int factor : {2, 3, 5})
      while (rest % factor == 0) rest /= factor;
    ASSERT_EQ(rest, 1) << n;
    ASSERT_GE(length, n);
    ASSERT_LE(length, n + n / 4 + 1) << "memory for " << n;
  }
  EXPECT_EQ(fft_good_length(4006), 4096) << "not 4050, which takes a quarter longer";
  EXPECT_EQ(fft_good_length(2174), 2250) << "not 2187, which takes a third longer";
  EXPECT_EQ(fft_good_length(3839), 3840);
  EXPECT_EQ(fft_good_length(2160), 2160);
  EXPECT_EQ(fft_good_length(7), 8);
  EXPECT_EQ(fft_good_length(0), 1);
}

TEST(Fft, RefusesATransformOfNothing) { EXPECT_THROW(Fft<float>(0, FftDirection::forward), Error); }

TYPED_TEST(Transforms, GoBackToWhatTheyCameFrom) {
  const int length = 1080;
  const auto data = noise<TypeParam>(length * columns);
  AlignedVector<std::complex<TypeParam>> spectrum(data.size()), back(data.size()), work(data.size());
  const ColumnFft<TypeParam> transform(length);
  transform(FftDirection::forward, data.data(), spectrum.data(), work.data());
  transform(FftDirection::backward, spectrum.data(), back.data(), work.data());
  // Both ways round by about √log₂(length) half epsilons of numbers below 1.
  for (size_t i = 0; i < data.size(); ++i)
    ASSERT_LT(std::abs(back[i] / TypeParam(length) - data[i]), 20 * std::numeric_limits<TypeParam>::epsilon()) << i;
}

// Any thread may use any of them at any time: the result does not depend on what `work` held.
TYPED_TEST(Transforms, DoNotDependOnTheirWorkSpace) {
  for (const int length : {6, 60, 1080, 1087}) {
    const auto data = noise<TypeParam>(length * columns);
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

TYPED_TEST(Transforms, TurnColumnsToRowsAndBack) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    for (const int length : {1, 3, 8, 29}) {
      const auto data = noise<TypeParam>(length * columns);  // [column][sample]
      std::array<const std::complex<TypeParam>*, columns> from;
      for (size_t c = 0; c < from.size(); ++c) from[c] = data.data() + c * size_t(length);
      AlignedVector<std::complex<TypeParam>> rows(data.size() + 1, TypeParam(7));
      turn_to_rows(from, length, rows.data());
      for (int i = 0; i < length; ++i)
        for (int c = 0; c < columns; ++c)
          ASSERT_EQ(rows[size_t(i * columns + c)], data[size_t(c * length + i)]) << name << ", " << length;
      EXPECT_EQ(rows.back(), std::complex<TypeParam>(7)) << "nothing is written beyond";
      AlignedVector<std::complex<TypeParam>> turned(data.size() + 1, TypeParam(7));
      turn_to_columns(rows.data(), length, turned.data());
      for (size_t i = 0; i < data.size(); ++i) ASSERT_EQ(turned[i], data[i]) << name << ", " << length;
      EXPECT_EQ(turned.back(), std::complex<TypeParam>(7));
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
