#include "holotrace/view/stereo.h"
#include "support/panels.h"

namespace holotrace {
namespace {

using namespace literals;

TEST(Stereo, EyesStandApartAboutTheEye) {
  RenderParams params;
  params.eye = {1_mm, 2_mm, 3_mm};
  params.eye_separation = 6_mm;
  const auto pair = stereo_pair(params);
  EXPECT_DOUBLE_EQ(pair[0].eye.x, -2_mm);
  EXPECT_DOUBLE_EQ(pair[1].eye.x, 4_mm);
  for (const RenderParams& eye : pair) {
    EXPECT_EQ(eye.eye.y, params.eye.y);
    EXPECT_EQ(eye.eye.z, params.eye.z);
    EXPECT_EQ(eye.eye_separation, 0);
  }
}

TEST(Stereo, TheAnaglyphOfEqualGreyPicturesIsThatGrey) {
  Image grey(4, 5, 1), colour(4, 5, 3);
  for (size_t i = 0; i < grey.values.size(); ++i) {
    grey.values[i] = float(i) / 7;
    for (size_t c = 0; c < 3; ++c) colour.values[3 * i + c] = grey.values[i];
  }
  for (const Image& picture : {grey, colour}) {
    const Image both = anaglyph(picture, picture);
    ASSERT_EQ(both.channels, 3);
    for (size_t i = 0; i < grey.values.size(); ++i)
      for (size_t c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(both.values[3 * i + c], grey.values[i]);
  }
}

TEST(Stereo, RedIsTheLeftLuminanceAndCyanTheRightPicture) {
  Image left(1, 1, 3), right(1, 1, 3);
  left.values = {0.5F, 0.25F, 1};
  right.values = {0.125F, 0.75F, 0.375F};
  const Image both = anaglyph(left, right);
  EXPECT_FLOAT_EQ(both(0, 0, 0), float(0.2126 * 0.5 + 0.7152 * 0.25 + 0.0722));
  EXPECT_EQ(both(0, 0, 1), 0.75F);
  EXPECT_EQ(both(0, 0, 2), 0.375F);
}

TEST(Stereo, PairsThatCannotBeAreRefused) {
  RenderParams params;
  params.eye_separation = -1e-3;
  EXPECT_EQ(error_of([&] { stereo_pair(params); }), "expected eyes more than 0 m apart for a stereo pair, got -1 mm");
  params.eye_separation = 6e-3;
  params.lens = Lens::panel;
  EXPECT_EQ(error_of([&] { stereo_pair(params); }),
            "expected a pinhole or a round lens for a stereo pair, got the panel, which has no eye; use another lens");
  EXPECT_EQ(error_of([&] { anaglyph(Image(2, 3, 1), Image(3, 2, 1)); }),
            "expected two pictures of one size for an anaglyph, got 3 × 2 pixels of 1 channel(s) and 2 × 3 of 1");
}

}  // namespace
}  // namespace holotrace
