#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/io/picture/animation.h"
#include "holotrace/io/picture/image_file.h"
#include "support/temporary.h"

namespace holotrace::test {
namespace {

// A bar of light that is farther right in each picture.
std::vector<Image> bars(int count, int nx, int ny) {
  std::vector<Image> images;
  for (int k = 0; k < count; ++k) {
    images.emplace_back(ny, nx, 1);
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) images.back()(j, i) = i / (nx / count) == k ? 2.0F : 0.1F;
  }
  return images;
}

struct Animation {
  std::vector<std::vector<float>> frames;
  int nx = 0, ny = 0, channels = 0, loops = -1;
  double seconds_per_frame = 0;
};

Animation load(const std::string& path) {
  Animation a;
  const auto input = OIIO::ImageInput::open(path);
  EXPECT_TRUE(input);
  for (int n = 0; input && input->seek_subimage(n, 0); ++n) {
    const OIIO::ImageSpec spec = input->spec();
    if (n == 0) {
      const auto* rate = spec.find_attribute("FramesPerSecond");
      if (rate) a.seconds_per_frame = 1 / (double(((const int*)rate->data())[0]) / ((const int*)rate->data())[1]);
      a.loops = spec.get_int_attribute("gif:LoopCount", -1);
    }
    a.nx = spec.width;
    a.ny = spec.height;
    a.channels = spec.nchannels;
    a.frames.emplace_back(size_t(spec.width) * size_t(spec.height) * size_t(spec.nchannels));
    input->read_image(n, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, a.frames.back().data());
  }
  OIIO::geterror();
  return a;
}

TEST(Animation, PlaysForwardAndBackEndlessly) {
  const std::string path = temporary("bars.gif");
  save_animation(path, bars(4, 64, 24), 2, 1.2);
  const Animation a = load(path);
  ASSERT_EQ(a.frames.size(), 6u);  // 1 2 3 4 3 2
  EXPECT_EQ(a.nx, 64);
  EXPECT_EQ(a.ny, 24);
  EXPECT_EQ(a.loops, 0);  // endless
  EXPECT_NEAR(a.seconds_per_frame, 0.2, 1e-6);
  const std::vector<size_t> shown{0, 1, 2, 3, 2, 1};
  for (size_t k = 0; k < shown.size(); ++k)
    for (size_t i = 0; i < 64; ++i) {
      const bool is_bright = i / 16 == shown[k];
      // 0.05 of white has the sRGB code 0.248; a palette of 256 colours per picture contains both colours, to one code.
      EXPECT_NEAR(a.frames[k][i * size_t(a.channels)], is_bright ? 1 : srgb_encode(0.05), 1.01 / 255) << k << " " << i;
    }
}

TEST(Animation, WidePicturesAreAveragedDown) {
  const Image wide = bars(1, 2000, 30)[0];
  const Image small = shrunk_to(wide, widest_animation);
  EXPECT_EQ(small.nx, 666);  // squares of 3
  EXPECT_EQ(small.ny, 10);
  EXPECT_EQ(shrunk_to(small, widest_animation).values, small.values);
  Image ramp(2, 4, 3);
  for (size_t i = 0; i < ramp.values.size(); ++i) ramp.values[i] = float(i);
  const Image half = shrunk_to(ramp, 2);
  ASSERT_EQ(half.nx, 2);
  EXPECT_FLOAT_EQ(half(0, 1, 2), (8 + 11 + 20 + 23) / 4.0F);
}

TEST(Animation, WhatCannotBeAnimatedIsRefused) {
  const std::string path = temporary("a.gif");
  EXPECT_EQ(error_of([&] { save_animation(path, bars(1, 8, 8), 1, 1); }),
            "expected 2 pictures or more to animate as " + path + ", got 1");
  auto uneven = bars(2, 8, 8);
  uneven[1] = Image(4, 8, 1);
  EXPECT_EQ(error_of([&] { save_animation(path, uneven, 1, 1); }),
            "expected pictures of 8 × 8 pixels to animate as " + path + ", got one of 8 × 4");
  EXPECT_EQ(error_of([&] { save_animation(path, bars(2, 8, 8), 0, 1); }),
            "expected a white level above 0 for " + path + ", got 0");
  EXPECT_EQ(error_of([&] { save_animation(path, bars(2, 8, 8), 1, 0); }),
            "expected an animation of more than 0 s for " + path + ", got 0 s");
  EXPECT_EQ(error_of([&] { save_animation("a.png", bars(2, 8, 8), 1, 1); }),
            "expected an animated file .gif, got a.png; change its extension");
}

}  // namespace
}  // namespace holotrace::test
