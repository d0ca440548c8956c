#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/view/pupil_picture.h"

namespace holotrace {
namespace {

// A pupil of 3 mm at 0.5 m: the first dark ring of the Airy pattern is 1.22·λs/D = 108 µm wide, 13.5 pixels of 8 µm.
constexpr double lambda = 532e-9, pupil = 3e-3, distance = 0.5, pitch = 8e-6;

TEST(DiffractionLimit, APointBecomesTheAiryPatternOfThePupilInEachColour) {
  Image picture(161, 181, 3);
  const double colours[] = {1, 0.5, 0};
  for (int c = 0; c < 3; ++c) picture(80, 90, c) = float(colours[c]);
  limit_to_pupil(picture, pitch, lambda, distance, pupil);
  const double peak = picture(80, 90, 0);
  double sum = 0;
  for (const float value : picture.values) sum += value;
  // Beyond 80 pixels are 2/(π·q) = 2.8 % of the pattern's light, which reflection brings back but for its repeats.
  EXPECT_NEAR(sum, 1.5, 0.03 * 1.5);
  // The irradiance of a pixel's light: pitch² over that of the pattern, πD²/4/(λs)².
  EXPECT_NEAR(peak, pi / 4 * std::pow(pupil * pitch / (lambda * distance), 2), 0.005 * peak);
  for (int j = 60; j <= 100; ++j)
    for (int i = 70; i <= 110; ++i) {
      const double q = pi * pupil * pitch * std::hypot(j - 80, i - 90) / (lambda * distance);
      const double airy = q == 0 ? 1 : std::pow(2 * std::cyl_bessel_j(1, q) / q, 2);
      EXPECT_NEAR(picture(j, i, 0) / peak, airy, 0.005) << i << " " << j;  // what repeats beyond the edges, and floats
      EXPECT_NEAR(picture(j, i, 1), picture(j, i, 0) / 2, 1e-6);
      EXPECT_EQ(picture(j, i, 2), 0);
    }
}

TEST(DiffractionLimit, EvenPicturesStayEvenAndNonsenseIsRefused) {
  Image even(30, 40, 1);
  for (float& value : even.values) value = 0.7F;
  limit_to_pupil(even, pitch, lambda, distance, pupil);
  for (const float value : even.values) EXPECT_NEAR(value, 0.7F, 1e-5);
  EXPECT_THROW(limit_to_pupil(even, pitch, 0, distance, pupil), Error);
  EXPECT_THROW(limit_to_pupil(even, pitch, lambda, 0, pupil), Error);
  EXPECT_THROW(limit_to_pupil(even, 0, lambda, distance, pupil), Error);
  Image none;
  EXPECT_THROW(limit_to_pupil(none, pitch, lambda, distance, pupil), Error);
}

// Two pictures that are blurred together, and a third, are those that are blurred one by one, to the rounding of floats.
TEST(DiffractionLimit, OfPicturesTogetherIsThatOfEach) {
  std::vector<Image> alone;
  for (int k = 0; k < 3; ++k) {
    Image& picture = alone.emplace_back(37, 50, 1);
    for (size_t i = 0; i < picture.values.size(); ++i)
      picture.values[i] = float(CounterRandom(uint64_t(k), 0, i).uniform());
  }
  std::vector<Image> together = alone;
  for (Image& picture : alone) limit_to_pupil(picture, pitch, lambda, distance, pupil);
  const PupilBlur blur(50, 37, pitch, lambda, distance, pupil);
  blur.apply(std::vector<PictureChannel>{{&together[0]}, {&together[1]}, {&together[2]}});
  for (int k = 0; k < 3; ++k)
    for (size_t i = 0; i < alone[0].values.size(); ++i)
      ASSERT_NEAR(together[size_t(k)].values[i], alone[size_t(k)].values[i], 1e-6) << k << ", " << i;
  Image other(38, 50, 1);
  EXPECT_THROW(blur.apply(std::vector<PictureChannel>{{&other}}), Error);
}

}  // namespace
}  // namespace holotrace
