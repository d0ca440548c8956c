// The chart of two images along a row.

#include <gtest/gtest.h>

#include "holotrace/view/comparison_plots.h"

namespace holotrace {
namespace {

// A part of 4 × 3 pixels that begins at row 2, column 5 of a picture of 10 × 11: its columns 5 … 7 lie symmetrically
// about the middle of 11 columns, column 5, from 0 on; its middle row is the fifth of the picture.
TEST(Profile, IsTheMiddleRowAtItsPlaceInTheWholePicture) {
  Image reference(4, 3, 1), image(4, 3, 3);
  for (int i = 0; i < 3; ++i) {
    reference(2, i) = float(i + 1);
    for (int c = 0; c < 3; ++c) image(2, i, c) = float(c);  // mean 1
  }
  const PartOfPicture part{.rows = 10, .columns = 11, .first_row = 2, .first_column = 5};
  const Chart pixels = profile_chart(reference, image, 2.5, part);
  EXPECT_EQ(pixels.title, "Row 5 of 10");
  ASSERT_EQ(pixels.series.size(), 2U);
  EXPECT_EQ(pixels.series[0].x, (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(pixels.series[0].y, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(pixels.series[1].y, (std::vector<double>{2.5, 2.5, 2.5}));
  reference.pitch = 0.25e-3;
  EXPECT_EQ(profile_chart(reference, image, 1, part).series[1].x, (std::vector<double>{0, 0.25, 0.5}));  // mm
}

}  // namespace
}  // namespace holotrace
