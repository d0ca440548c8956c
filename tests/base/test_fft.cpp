#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/fft_stages.h"
#include "holotrace/base/machine.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

template <class Real>
AlignedVector<std::complex<Real>> noise(int count) {
  AlignedVector<std::complex<Real>> data;
  CounterRandom random(17, 0, 0);
  for (int i = 0; i < count; ++i) data.emplace_back(Real(random.uniform() - 0.5), Real(random.uniform() - 0.5));
  return data;
}

constexpr long double full_turn = 2 * std::numbers::pi_v<long double>;

// Sample k of a transform by the definition. In double its own rounding would be the larger one.
template <class Real>
std::complex<long double> slow_transform(const AlignedVector<std::complex<Real>>& data, int k, int sign) {
  const auto n = int64_t(data.size());
  std::complex<long double> sum;
  for (int64_t i = 0; i < n; ++i)
    sum += std::complex<long double>(data[size_t(i)]) *
           std::polar(1.0L, sign * full_turn * (long double)(k * i % n) / (long double)n);
  return sum;
}

template <class Real>
class LineTransforms : public ::testing::Test {
 protected:
  // Compares `samples` of the spectrum with the definition. They are about √(length/6). Each of its log₂(length) levels
  // rounds them by an epsilon or less, at random, by sums, products and factors: together 0.4·√(length·levels) epsilons
  // as a standard deviation; a convolution with a chirp has twice as many levels. Five times the former is beyond chance.
  static void expect_the_definition(int length, int samples) {
    const auto data = noise<Real>(length);
    const long double tolerance =
        2 * std::numeric_limits<Real>::epsilon() * std::sqrt(length * (1 + std::log2((long double)length)));
    for (const auto& [direction, sign] : {std::pair{FftDirection::forward, -1}, {FftDirection::backward, 1}}) {
      const Fft<Real> transform(length, direction);
      AlignedVector<std::complex<Real>> out(data.size()), in_place = data;
      transform(data.data(), out.data());
      for (int n = 0; n < samples; ++n) {
        const int k = int(int64_t(n) * length / samples);
        ASSERT_LT(std::abs(std::complex<long double>(out[size_t(k)]) - slow_transform(data, k, sign)), tolerance)
            << "sample " << k << " of " << length << ", sign " << sign;
      }
      transform(in_place.data());
      EXPECT_EQ(in_place, out) << length;
    }
    EXPECT_EQ(data, noise<Real>(length)) << "the input is not changed";
  }
};

using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(LineTransforms, Reals);

// Of these, 17, 19, … have other factors than 2 to 13.
TYPED_TEST(LineTransforms, AreTheDefinitionForAllShortLengths) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    for (int length = 1; length <= 100; ++length) TestFixture::expect_the_definition(length, length);
  }
}

// Rows of panels: whole blocks of columns, parts of them, all radices, and prime numbers (683·2, 97·28, 1087).
TYPED_TEST(LineTransforms, AreTheDefinitionForPanels) {
  for (const std::string& name : instruction_sets()) {
    const OnInstructionSet only(name);
    for (const int length : {1001, 1024, 1050, 1087, 1280, 1366, 1920, 2187, 2716, 3840, 4096, 4099, 4199})
      TestFixture::expect_the_definition(length, 7);
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

TYPED_TEST(LineTransforms, TakeDataThatAreNotAligned) {
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
TYPED_TEST(LineTransforms, DoNotDependOnEarlierOnes) {
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

}  // namespace
}  // namespace holotrace
