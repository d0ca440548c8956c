#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "holotrace/io/picture/image_file.h"

namespace holotrace::test {
namespace {

// The formula itself: 255 times the code of sRGB, rounded to the nearest.
uint8_t code_by_formula(double linear) {
  const double clipped = linear > 0 ? std::min(linear, 1.0) : 0.0;
  const double code = clipped <= 0.0031308 ? 12.92 * clipped : 1.055 * std::pow(clipped, 1 / 2.4) - 0.055;
  return uint8_t(std::lround(255 * code));
}

TEST(SrgbCodes, AreThoseOfTheFormula) {
  std::vector<float> values{0,
                            -1,
                            0.5F,
                            1,
                            2,
                            1e-30F,
                            std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity(),
                            std::nanf("")};
  for (int i = 0; i < 100000; ++i) values.push_back(float(i) / 99999);
  for (int code = 1; code < 256; ++code) {  // and the floats on both sides of each step
    const double half = (code - 0.5) / 255;
    float at = float(half <= 0.04045 ? half / 12.92 : std::pow((half + 0.055) / 1.055, 2.4));
    for (int i = 0; i < 3; ++i) at = std::nextafter(at, 0.0F);
    for (int i = 0; i < 7; ++i, at = std::nextafter(at, 2.0F)) values.push_back(at);
  }
  Image image(1, int(values.size()), 1);
  image.values = values;
  for (const double white : {1.0, 0.7, 1.0 / 3}) {
    const std::vector<uint8_t> codes = srgb_codes(image, white);
    for (size_t i = 0; i < values.size(); ++i)
      ASSERT_EQ(codes[i], code_by_formula(double(values[i]) / white)) << values[i];
  }
}

TEST(SrgbCodes, AreInTheOrderOfTheImage) {
  Image image(2, 3, 3);
  for (size_t i = 0; i < image.values.size(); ++i) image.values[i] = float(i) / 17;
  const std::vector<uint8_t> codes = srgb_codes(image, 1);
  ASSERT_EQ(codes.size(), 18u);
  EXPECT_TRUE(std::is_sorted(codes.begin(), codes.end()));
}

}  // namespace
}  // namespace holotrace::test
