#include <gtest/gtest.h>

#include <limits>

#include "holotrace/io/picture/depth_image_file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::temporary;

std::string picture_file(const std::string& name, int ny, int nx, int channels, float value = 0.5F) {
  Image image(ny, nx, channels);
  for (float& v : image.values) v = value;
  const std::string path = temporary(name);
  save_image(path, image, 1, 8);
  return path;
}

// Values of the depth file are numbers in [0, 1] that are not decoded like the picture's: brighter is nearer.
std::string depth_file(const std::string& name, int bits, int channels = 1) {
  Image image(2, 3, channels);
  for (int c = 0; c < channels; ++c) {
    image(0, 0, c) = 0;
    image(0, 1, c) = 1;
    image(1, 2, c) = float(srgb_decode(0.2));  // code 51 of 255, 13107 of 65535
  }
  const std::string path = temporary(name);
  save_image(path, image, 1, bits);
  return path;
}

TEST(DepthImageFile, BrighterIsNearerLinearlyInMetres) {
  const std::string picture = picture_file("p.png", 2, 3, 3);
  for (const int bits : {8, 16})
    for (const int channels : {1, 3}) {
      const DepthImage image = load_depth_image(picture, depth_file("d.png", bits, channels), 0.1, 0.2);
      EXPECT_EQ(image.picture.channels, 3);
      EXPECT_FLOAT_EQ(image.depth(0, 0), 0.2F);
      EXPECT_FLOAT_EQ(image.depth(0, 1), 0.1F);
      EXPECT_FLOAT_EQ(image.depth(1, 2), 0.2F - 0.2F * 0.1F);
    }
}

TEST(DepthImageFile, AnExrHasMetres) {
  Image metres(2, 3, 1);
  metres(1, 1) = 0.25F;
  const std::string path = temporary("d.exr");
  save_image(path, metres, 1, 8);
  const DepthImage image = load_depth_image(picture_file("p.png", 2, 3, 1), path, 0, 0);
  EXPECT_EQ(image.depth(1, 1), 0.25F);
  EXPECT_EQ(image.depth(0, 0), 0);
}

TEST(DepthImageFile, BlackMayBeNearerAndDisparityIsTheInverse) {
  const std::string picture = picture_file("p.png", 2, 3, 3), depth = depth_file("d.png", 16);
  const DepthImage black_near = load_depth_image(picture, depth, 0.2, 0.1);
  EXPECT_FLOAT_EQ(black_near.depth(0, 0), 0.1F);
  EXPECT_FLOAT_EQ(black_near.depth(0, 1), 0.2F);
  const DepthImage disparity = load_depth_image(picture, depth, 0.1, 0.2, DepthScale::disparity);
  EXPECT_FLOAT_EQ(disparity.depth(0, 0), 0.2F);
  EXPECT_FLOAT_EQ(disparity.depth(0, 1), 0.1F);
  EXPECT_FLOAT_EQ(disparity.depth(1, 2), 1 / (5 + 0.2F * 5));  // 1/m: 5 for black, 10 for white
}

// Dark pixels behind all light hide nothing, in front of the panel too.
TEST(DepthImageFile, PixelsWithoutLightBehindAllOthersAreLeftOut) {
  Image picture(1, 3, 1), metres(1, 3, 1);
  const float depths[] = {-0.1F, -0.05F, -0.2F};
  for (int i = 0; i < 3; ++i) metres(0, i) = depths[i], picture(0, i) = i == 0 ? 1.0F : 0.0F;
  const std::string p = temporary("p.exr"), d = temporary("d.exr");
  save_image(p, picture, 1, 8);
  save_image(d, metres, 1, 8);
  const DepthImage image = load_depth_image(p, d, 0, 0);
  const float expected[] = {-0.1F, 0, -0.2F};
  for (int i = 0; i < 3; ++i) EXPECT_EQ(image.depth(0, i), expected[i]) << i;
}

// Renderers write 0, a huge number or infinity where a ray hits nothing.
TEST(DepthImageFile, PixelsWithoutLightNeedNoDepth) {
  Image picture(1, 5, 1), metres(1, 5, 1);
  const float depths[] = {0.2F, 1e10F, std::numeric_limits<float>::infinity(), 0.1F, 0};
  for (int i = 0; i < 5; ++i) metres(0, i) = depths[i], picture(0, i) = i < 2 ? 1.0F : 0.0F;
  const std::string p = temporary("p.exr"), d = temporary("d.exr");
  save_image(p, picture, 1, 8);
  save_image(d, metres, 1, 8);
  const DepthImage image = load_depth_image(p, d, 0, 0);
  const float expected[] = {0.2F, 0, 0, 0.1F, 0};  // the dark one in front can hide others
  for (int i = 0; i < 5; ++i) EXPECT_EQ(image.depth(0, i), expected[i]) << i;
}

// Grey from 5 mm in front of the panel (white) to 5 mm behind it; 0 would mean that nothing is there.
TEST(DepthImageFile, DepthsGoThroughThePanel) {
  const std::string depth = temporary("through.exr"), picture = picture_file("p3.png", 1, 3, 1);
  Image metres(1, 3, 1);
  metres(0, 0) = 5e-3F, metres(0, 1) = -5e-3F, metres(0, 2) = 0;
  save_image(depth, metres, 1, 8);
  const DepthImage exr = load_depth_image(picture, depth, 0, 0);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(exr.depth(0, i), metres(0, i)) << i;
  const std::string file = depth_file("through.png", 8);
  const DepthImage image = load_depth_image(picture_file("p.png", 2, 3, 3), file, -5e-3, 20e-3);  // codes 0, 255, 51
  EXPECT_FLOAT_EQ(image.depth(0, 0), 20e-3F);
  EXPECT_FLOAT_EQ(image.depth(0, 1), -5e-3F);
  const DepthImage through = load_depth_image(picture_file("p.png", 2, 3, 3), file, 0, 20e-3);
  EXPECT_FLOAT_EQ(through.depth(0, 1), 1e-9F) << "in the panel, and there";
}

TEST(DepthImageFile, ErrorsNameTheFileAndSayWhatToDo) {
  const std::string picture = picture_file("p.png", 2, 3, 3), depth = depth_file("d.png", 8);
  const auto error = [&](const std::string& p, const std::string& d, double near, double far) {
    return error_of([&] { load_depth_image(p, d, near, far); });
  };
  const std::string range = depth + ": expected two different depths of its white and black, got near ";
  EXPECT_EQ(error(picture, depth, 0, 0), range + "0 m and far 0 m; give near and far");
  EXPECT_EQ(error(picture, depth, 0.2, 0.2), range + "200 mm and far 200 mm; give near and far");
  EXPECT_EQ(error(picture, depth, 0.2, NAN).rfind(range, 0), 0U);
  EXPECT_EQ(error_of([&] { load_depth_image(picture, depth, -0.1, 0.1, DepthScale::disparity); }),
            depth +
                ": expected near and far on one side of the panel with the disparity, the inverse of the depth, got "
                "-100 mm and 100 mm; use the depth scale depth");
  const std::string small = picture_file("s.png", 2, 2, 1);
  EXPECT_EQ(error(picture, small, 0.1, 0.2), small + ": expected depths for 3 × 2 pixels, as " + picture +
                                                 " has, got 2 × 2; make both pictures one size");
  EXPECT_EQ(error(picture, "none.png", 0.1, 0.2),
            "expected an image at none.png, but there is no such file; check the path");
  Image coloured(2, 3, 3);
  coloured(1, 2, 1) = 1;
  const std::string colours = temporary("c.png");
  save_image(colours, coloured, 1, 8);
  EXPECT_EQ(
      error(picture, colours, 0.1, 0.2),
      colours + ": expected a grey picture of depths, got a colour at row 1, column 2; is it the picture itself?");
  const std::string metres = temporary("d.exr");
  save_image(metres, Image(2, 3, 1), 1, 8);
  EXPECT_EQ(error(picture, metres, 0.1, 0.2),
            metres + ": expected no near, far and scale with a depth EXR, which has metres, got 100 mm and 200 mm");
  EXPECT_EQ(error(picture, metres, 0, 0),
            picture + " with " + metres + ": expected a pixel with a depth other than 0 m (nothing there), got none");
}

}  // namespace
}  // namespace holotrace
