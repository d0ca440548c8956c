// A render on the pixels of a view, and grey from colours.

#include <gtest/gtest.h>

#include "holotrace/view/combine_views.h"
#include "support/panels.h"

namespace holotrace::test {
namespace {

TEST(OnPixelsOf, TakesTheMeanOverEachPixel) {
  Image fine(4, 6, 1);
  for (size_t i = 0; i < fine.values.size(); ++i) fine.values[i] = float(i * i);
  const Image coarse = on_pixels_of(fine, Image(2, 3, 1));
  ASSERT_EQ(coarse.ny, 2);
  ASSERT_EQ(coarse.nx, 3);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 3; ++i) {
      const float mean =
          (fine(2 * j, 2 * i) + fine(2 * j, 2 * i + 1) + fine(2 * j + 1, 2 * i) + fine(2 * j + 1, 2 * i + 1)) / 4;
      EXPECT_NEAR(coarse(j, i), mean, 1e-4) << j << " " << i;  // floats of up to 529
    }
}

TEST(OnPixelsOf, RefusesAnotherShape) {
  EXPECT_EQ(error_of([] { on_pixels_of(Image(30, 40, 1), Image(30, 30, 1)); }),
            "expected two pictures of the same shape, got 40 × 30 and 30 × 30 pixels; crop one of "
            "them, or add --register if one is a photograph");
  EXPECT_EQ(on_pixels_of(Image(512, 910, 1), Image(1080, 1920, 1)).nx, 1920);  // 16:9 to half a pixel of 512 rows
}

TEST(Luminance, WeighsColoursAsTheEyeDoes) {
  Image colour(1, 4, 3);
  for (int c = 0; c < 3; ++c) colour(0, c, c) = 1;
  for (int c = 0; c < 3; ++c) colour(0, 3, c) = 0.5f;
  const Image grey = luminance_of(colour);
  ASSERT_EQ(grey.channels, 1);
  EXPECT_FLOAT_EQ(grey(0, 0), 0.2126f);  // ITU-R BT.709
  EXPECT_FLOAT_EQ(grey(0, 1), 0.7152f);
  EXPECT_FLOAT_EQ(grey(0, 2), 0.0722f);
  EXPECT_FLOAT_EQ(grey(0, 3), 0.5f);
}

}  // namespace
}  // namespace holotrace::test
