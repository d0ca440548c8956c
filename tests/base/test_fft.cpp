#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
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

// The definition of the transform, summed in double.
std::vector<std::complex<double>> slow_transform(const std::complex<double>* data, int n, int sign) {
  std::vector<std::complex<double>> out(static_cast<size_t>(n));
  for (int k = 0; k < n; ++k)
    for (int i = 0; i < n; ++i)
      out[size_t(k)] += data[i] * std::polar(1.0, sign * 2 * pi * double(int64_t(k) * i % n) / n);
  return out;
}

TEST(Fft, IsTheDefinitionForwardAndBackward) {
  for (const int n : {1, 2, 7, 30, 127, 240}) {
    for (const auto& [direction, sign] : {std::pair{FftDirection::forward, -1}, {FftDirection::backward, 1}}) {
      auto data = noise<double>(n);
      const auto expected = slow_transform(data.data(), n, sign);
      Fft<double>(n, direction)(data.data());
      // √n sums of numbers below 1, each with an error of 1e-16
      for (int k = 0; k < n; ++k) EXPECT_LT(std::abs(data[size_t(k)] - expected[size_t(k)]), 1e-13) << n;
    }
  }
}

TEST(Fft, TransformsDataOffTheSimdBoundaryAlike) {
  const int n = 60;
  auto data = noise<float>(n + 1);
  AlignedVector<std::complex<float>> aligned(data.begin() + 1, data.end());
  const Fft<float> forward(n, FftDirection::forward);
  forward(data.data() + 1);
  forward(aligned.data());
  for (int k = 0; k < n; ++k) EXPECT_LT(std::abs(data[size_t(k) + 1] - aligned[size_t(k)]), 1e-5F);  // 60·2⁻²⁴
}

// Columns of a row-major block become contiguous spectra, and columns again.
TEST(FftBatch, TransformsColumnsAsOneByOne) {
  for (const int n : {1, 12, 35, 90}) {
    constexpr int columns = 4;
    const auto block = noise<double>(n * columns);
    AlignedVector<std::complex<double>> spectra(block.size()), back(block.size());
    FftBatch<double>(n, {columns, columns, 1, 1, n}, FftDirection::forward)(block.data(), spectra.data());
    FftBatch<double>(n, {columns, 1, n, columns, 1}, FftDirection::backward)(spectra.data(), back.data());
    for (int c = 0; c < columns; ++c) {
      std::vector<std::complex<double>> column;
      for (int i = 0; i < n; ++i) column.push_back(block[size_t(i * columns + c)]);
      const auto expected = slow_transform(column.data(), n, -1);
      for (int k = 0; k < n; ++k)
        EXPECT_LT(std::abs(spectra[size_t(c * n + k)] - expected[size_t(k)]), 1e-13) << n;  // as above
    }
    for (size_t i = 0; i < block.size(); ++i) EXPECT_LT(std::abs(back[i] / double(n) - block[i]), 1e-15) << n;
  }
}

// A plan for aligned data would crash for some of these lengths.
TEST(FftBatch, TakesDataThatAreNotAligned) {
  for (const int n : {6, 20, 30, 36, 45, 50, 60, 84, 90, 126, 150, 200, 250, 270, 300, 450, 750, 1350}) {
    const auto data = noise<float>(n + 1);
    AlignedVector<std::complex<float>> aligned(data.begin() + 1, data.end()), expected(aligned.size()),
        out(data.size());
    const FftBatch<float> transform(n, {}, FftDirection::forward);
    transform(aligned.data(), expected.data());
    transform(data.data() + 1, out.data() + 1);
    for (int k = 0; k < n; ++k)
      EXPECT_LT(std::abs(out[size_t(k + 1)] - expected[size_t(k)]), 1e-5 * std::sqrt(n)) << n;  // rounding of floats
  }
}

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
    if (n > 64) {
      ASSERT_EQ(length % 4, 0) << "four samples are a register: " << n;
    }
  }
  EXPECT_EQ(fft_good_length(4006), 4096) << "not 4050, which takes 1.8 times as long";
  EXPECT_EQ(fft_good_length(2174), 2304) << "not 2187, which takes three times as long";
  EXPECT_EQ(fft_good_length(3839), 3840);
  EXPECT_EQ(fft_good_length(2160), 2160);
  EXPECT_EQ(fft_good_length(7), 8);
  EXPECT_EQ(fft_good_length(0), 1);
}

// A program takes from the store what another one measured, and plans alike.
TEST(Fft, UsesItsStoreForEachNewPlanAndKeepsTheWisdom) {
  std::string kept = "no wisdom";  // invalid wisdom is ignored
  int opened = 0, closed = 0;
  FftWisdomStore store;
  store.open = [&] {
    ++opened;
    return kept;
  };
  store.close = [&](const std::string& wisdom) {
    ++closed;
    kept = wisdom;
  };
  set_fft_wisdom_store(store);
  const Fft<float> first(1155, FftDirection::forward), again(1155, FftDirection::forward);
  EXPECT_EQ(opened, 1);
  EXPECT_EQ(closed, 1);
  // One transform out of place; with one transform, a different distance is the same problem for FFTW, which has a plan.
  const FftBatch<float> batch(1155, {}, FftDirection::forward);
  EXPECT_EQ(opened, 2);
  const FftBatch<float> known(1155, {.input_distance = 7, .output_distance = 7}, FftDirection::forward);
  EXPECT_EQ(opened, 2);
  EXPECT_EQ(closed, 2);
  set_fft_wisdom_store({[] { return std::string(); }, [](const std::string&) {}});
  EXPECT_NE(kept.find("fftwf_wisdom"), std::string::npos);  // wisdom of both precisions
  EXPECT_NE(kept.find("fftw_wisdom"), std::string::npos);
}

TEST(Fft, RefusesATransformOfNothing) { EXPECT_THROW(Fft<float>(0, FftDirection::forward), Error); }

TEST(FftBatch, RefusesATransformOfNothing) {
  EXPECT_THROW(FftBatch<float>(8, {.count = 0}, FftDirection::forward), Error);
}

}  // namespace
}  // namespace holotrace
