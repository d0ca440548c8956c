#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "holotrace/base/error.h"
#include "holotrace/data/spectrum.h"

namespace holotrace {
namespace {

// The colour that the wavelengths reproduce: M·W·rgb.
Vec3 round_trip(const std::vector<double>& wavelengths, Vec3 rgb) {
  const std::vector<Vec3> matrix = colour_matrix(wavelengths);
  Vec3 seen;
  for (size_t n = 0; n < wavelengths.size(); ++n) seen += matrix[n] * radiance_at(wavelengths[n], rgb);
  return seen;
}

void expect_near(Vec3 a, Vec3 b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

// For these the condition number of W is below 10, that of WᵀW below 100: 100 rounding errors of 2e-16.
constexpr double rounding = 1e-13;

TEST(ColourMatrix, RecoversEveryColourIfTheWavelengthsDistinguishThree) {
  for (const std::vector<double>& wavelengths : {std::vector<double>{638e-9, 520e-9, 450e-9},
                                                 {630e-9, 532e-9, 460e-9},
                                                 {660e-9, 600e-9, 550e-9, 500e-9, 440e-9}})
    for (const Vec3 rgb : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.2, 0.5, 0.9}})
      expect_near(round_trip(wavelengths, rgb), rgb, rounding);
}

TEST(ColourMatrix, EqualLightAtAllWavelengthsIsWhite) {
  for (const std::vector<double>& wavelengths : {std::vector<double>{638e-9, 520e-9, 450e-9},
                                                 {630e-9, 532e-9, 460e-9},
                                                 {660e-9, 600e-9, 550e-9, 500e-9, 440e-9}}) {
    Vec3 sum;
    for (const Vec3 column : colour_matrix(wavelengths)) sum += column;
    expect_near(sum, {1, 1, 1}, rounding);
  }
}

TEST(ColourMatrix, OnTheThreeLinesOfTheScenesColoursItIsTheIdentity) {
  const std::vector<Vec3> matrix = colour_matrix({red_line, green_line, blue_line});
  expect_near(matrix[0], {1, 0, 0}, rounding);
  expect_near(matrix[1], {0, 1, 0}, rounding);
  expect_near(matrix[2], {0, 0, 1}, rounding);
}

TEST(ColourMatrix, IsTheMoorePenroseInverse) {
  // M·W·M = M and W·M·W = W with both products symmetric, for ranks 3, 2 and 1.
  for (const std::vector<double>& wavelengths : {std::vector<double>{638e-9, 590e-9, 520e-9, 450e-9},
                                                 {638e-9, 520e-9},
                                                 {650e-9, 640e-9, 450e-9},
                                                 {650e-9, 640e-9},
                                                 {500e-9}}) {
    const std::vector<Vec3> m = colour_matrix(wavelengths);
    for (const double wavelength : wavelengths)  // W·M·W = W, row by row
      for (const Vec3 e : {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}})
        EXPECT_NEAR(radiance_at(wavelength, round_trip(wavelengths, e)), radiance_at(wavelength, e), rounding);
    for (size_t a = 0; a < m.size(); ++a)  // W·M symmetric
      for (size_t b = 0; b < m.size(); ++b)
        EXPECT_NEAR(radiance_at(wavelengths[a], m[b]), radiance_at(wavelengths[b], m[a]), rounding);
    const Vec3 red = round_trip(wavelengths, {1, 0, 0}), green = round_trip(wavelengths, {0, 1, 0});
    EXPECT_NEAR(red.y, green.x, rounding);                                                             // M·W symmetric
    for (size_t n = 0; n < m.size(); ++n) expect_near(round_trip(wavelengths, m[n]), m[n], rounding);  // M·W·M = M
  }
}

TEST(ColourMatrix, TwoWavelengthsGiveTheNearestColoursThatTheyCanShow) {
  // 638 nm is pure red; 520 nm is 5/6 green and 1/6 blue, so blue and green are recovered in that proportion.
  const Vec3 white = round_trip({638e-9, 520e-9}, {1, 1, 1});
  const double g = 60. / 72, b = 12. / 72, square = g * g + b * b;
  expect_near(white, {1, g / square, b / square}, rounding);
}

TEST(ColourMatrix, WavelengthsTooCloseToDistinguishCountAsOne) {
  // 0.1 pm apart: weights differ by 1e-4/98 = 1e-6, squares of singular values by 1e-12 of the largest. Separating
  // their colours would amplify noise a million times; as one colour, no column exceeds that of one wavelength.
  const std::vector<Vec3> near = colour_matrix({600e-9, 600.0001e-9}), one = colour_matrix({600e-9});
  for (const Vec3 column : near) EXPECT_LT(length(column * 2 - one[0]), 1e-5);  // 1e-6, with a margin
}

// W·M is the identity: colours of two wavelengths show each at its own irradiance. Rows 1 nm apart have singular values
// of a ratio of some 200, whose square times 2e-16 bounds the rounding.
TEST(ColourMatrix, TellsWavelengthsApartThatDifferByANanometre) {
  const std::vector<double> wavelengths{520e-9, 521e-9};
  const std::vector<Vec3> columns = colour_matrix(wavelengths);
  for (size_t n = 0; n < 2; ++n)
    for (size_t k = 0; k < 2; ++k)
      EXPECT_NEAR(dot(channel_weights(wavelengths[n]), columns[k]), n == k ? 1 : 0, 1e-11) << n << k;
}

TEST(ColourMatrix, RefusesNoWavelengthAndBadOnes) {
  EXPECT_THROW(colour_matrix({}), Error);
  EXPECT_THROW(colour_matrix({532e-9, 0}), Error);
  EXPECT_THROW(colour_matrix({std::numeric_limits<double>::quiet_NaN()}), Error);
}

}  // namespace
}  // namespace holotrace
