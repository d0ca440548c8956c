#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/random.h"
#include "holotrace/estimate/picture_quality.h"
#include "support/error_of.h"

namespace holotrace {
namespace {

TEST(PictureNoise, IsTheDeviationOfOnePictureOverItsLight) {
  CounterRandom random(3, 0, 0);
  Image a(200, 100, 1), b = a;
  // Uniform numbers in ±0.3 around 2 have a deviation of 0.3/√3.
  for (Image* picture : {&a, &b})
    for (float& value : picture->values) value = float(2 + 0.3 * (2 * random.uniform() - 1));
  // The variance of 20 000 differences is known to √(2.4/20 000) of it (their kurtosis is 2.4), the noise to half of that,
  // 0.55 %: four such errors.
  EXPECT_NEAR(picture_noise(a, b), 0.3 / std::sqrt(3.0) / 2, 0.022 * 0.3 / std::sqrt(3.0) / 2);
  EXPECT_EQ(picture_noise(a, a), 0);
}

TEST(PictureNoise, NeedsTwoPicturesOfOneSizeWithLight) {
  const Image small(2, 3, 1), large(3, 3, 1);
  EXPECT_EQ(error_of([&] { picture_noise(small, large); }),
            "expected two pictures of one size, got 3 × 2 and 3 × 3 pixels");
  EXPECT_EQ(error_of([&] { picture_noise(small, small); }), "expected pictures with light, got dark ones");
}

}  // namespace
}  // namespace holotrace
