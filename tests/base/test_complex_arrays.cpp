#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/random.h"

namespace holotrace {
namespace {

template <class Real>
AlignedVector<std::complex<Real>> noise(size_t count, uint32_t seed) {
  AlignedVector<std::complex<Real>> values;
  CounterRandom random(seed, 0, 0);
  for (size_t i = 0; i < count; ++i) values.emplace_back(Real(random.uniform() - 0.5), Real(random.uniform() - 0.5));
  return values;
}

template <class Real>
class ComplexArrays : public ::testing::Test {
 protected:
  // Three rounding errors of numbers below 1.
  void expect_near(std::complex<Real> a, std::complex<Real> b) {
    EXPECT_LT(std::abs(a - b), 3 * std::numeric_limits<Real>::epsilon());
  }
};

using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(ComplexArrays, Reals);

// Counts that fill vectors and counts that do not, at addresses off the vector boundaries.
TYPED_TEST(ComplexArrays, MultiplyAndAddNumberByNumber) {
  for (const size_t count : {0, 1, 3, 8, 21, 64})
    for (const size_t offset : {0, 1}) {
      const auto a = noise<TypeParam>(count + offset, 1), b = noise<TypeParam>(count + offset, 2);
      auto product = noise<TypeParam>(count + offset + 1, 3), sum = product;
      const auto before = product;
      multiply(product.data() + offset, a.data() + offset, b.data() + offset, count);
      multiply_add(sum.data() + offset, a.data() + offset, b.data() + offset, count);
      for (size_t i = offset; i < count + offset; ++i) {
        this->expect_near(product[i], a[i] * b[i]);
        this->expect_near(sum[i], before[i] + a[i] * b[i]);
      }
      EXPECT_EQ(product.back(), before.back());  // nothing is written past the end
      EXPECT_EQ(sum.back(), before.back());
    }
}

TYPED_TEST(ComplexArrays, MultiplyAndAddConjugates) {
  for (const size_t count : {0, 1, 3, 8, 21, 64})
    for (const size_t offset : {0, 1}) {
      const auto a = noise<TypeParam>(count + offset, 1), b = noise<TypeParam>(count + offset, 2);
      auto product = noise<TypeParam>(count + offset + 1, 3), sum = product;
      const auto before = product;
      multiply_conjugate(product.data() + offset, a.data() + offset, b.data() + offset, count);
      multiply_conjugate_add(sum.data() + offset, a.data() + offset, b.data() + offset, count);
      for (size_t i = offset; i < count + offset; ++i) {
        this->expect_near(product[i], a[i] * std::conj(b[i]));
        this->expect_near(sum[i], before[i] + a[i] * std::conj(b[i]));
      }
      EXPECT_EQ(product.back(), before.back());  // nothing is written past the end
      EXPECT_EQ(sum.back(), before.back());
    }
}

TYPED_TEST(ComplexArrays, MultiplyInPlace) {
  const auto a = noise<TypeParam>(37, 4), b = noise<TypeParam>(37, 5);
  auto product = a;
  multiply(product.data(), product.data(), b.data(), a.size());
  auto conjugate = a;
  multiply_conjugate(conjugate.data(), conjugate.data(), b.data(), a.size());
  for (size_t i = 0; i < a.size(); ++i) {
    this->expect_near(product[i], a[i] * b[i]);
    this->expect_near(conjugate[i], a[i] * std::conj(b[i]));
  }
}

TYPED_TEST(ComplexArrays, MultiplyRowsByTheirFactors) {
  for (const size_t width : {1, 5, 16}) {
    const size_t rows = 7;
    const auto a = noise<TypeParam>(rows * width, 6), factor = noise<TypeParam>(rows, 7);
    auto product = a, sum = a;
    multiply_rows(product.data(), a.data(), factor.data(), rows, width);
    multiply_add_rows(sum.data(), a.data(), factor.data(), rows, width);
    for (size_t i = 0; i < a.size(); ++i) {
      this->expect_near(product[i], a[i] * factor[i / width]);
      this->expect_near(sum[i], a[i] + a[i] * factor[i / width]);
    }
  }
}

TYPED_TEST(ComplexArrays, EnergyIsTheSumOfSquaredModuli) {
  for (const size_t count : {0, 3, 50}) {
    const auto a = noise<TypeParam>(count, 8);
    double expected = 0;
    for (const auto& v : a) expected += std::norm(std::complex<double>(v));
    EXPECT_NEAR(energy(a.data(), count), expected, 1e-14 * double(count));  // summed in another order
  }
}

}  // namespace
}  // namespace holotrace
