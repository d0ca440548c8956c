#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/animation.h"
#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/image_file.h"
#include "support/gif.h"
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

TEST(Animation, PlaysForwardAndBackEndlessly) {
  const std::string path = temporary("bars.gif");
  save_animation(path, bars(4, 64, 24), 2, 1.2);
  const Gif gif = load_gif(path);
  ASSERT_EQ(gif.frames.size(), 6u);  // 1 2 3 4 3 2
  EXPECT_EQ(gif.nx, 64);
  EXPECT_EQ(gif.ny, 24);
  EXPECT_EQ(gif.loops, 0);        // endless
  EXPECT_EQ(gif.hundredths, 20);  // 1.2 s by 6 frames
  const std::vector<size_t> shown{0, 1, 2, 3, 2, 1};
  for (size_t k = 0; k < shown.size(); ++k)
    for (size_t i = 0; i < 64 * 24; ++i) {
      const bool is_bright = i % 64 / 16 == shown[k];
      // 0.05 of white has the sRGB code 0.248: 63. A palette of 256 colours contains both colours.
      const int code = is_bright ? 255 : int(std::lround(255 * srgb_encode(0.05)));
      for (size_t c = 0; c < 3; ++c) ASSERT_EQ(gif.frames[k][3 * i + c], code) << k << " " << i;
    }
}

TEST(Film, PlaysForward) {
  const std::string path = temporary("bars.gif");
  const std::vector<Image> images = bars(4, 64, 24);
  size_t made = 0;
  const auto picture = [&](size_t i) {
    ++made;
    return images[i];
  };
  save_film(path, {4, picture}, 8);
  EXPECT_EQ(made, 5u);  // the first one also tells the size; none is made twice more
  const Gif gif = load_gif(path);
  ASSERT_EQ(gif.frames.size(), 4u);
  for (size_t k = 0; k < 4; ++k) EXPECT_EQ(gif.frames[k][3 * (16 * k + 1)], 255) << k;  // 2, clipped to white
  EXPECT_EQ(error_of([&] {
              save_film(path, {0, picture}, 8);
            }),
            "expected 1 picture or more for the film " + path + ", got none");
  const auto uneven = [&](size_t i) { return i == 0 ? Image(8, 8, 1) : Image(8, 9, 1); };
  EXPECT_EQ(error_of([&] {
              save_film(path, {2, uneven}, 8);
            }),
            "expected pictures of 8 × 8 pixels to animate as " + path + ", got one of 9 × 8");
}

// A GIF has hundredths of a second, and shows pictures for two of them or more; a WebP has thousandths.
TEST(Film, FasterThanItsFormatIsAnError) {
  for (const auto& [ending, most] : {std::pair(".gif", 50.0), std::pair(".webp", 1000.0)}) {
    const std::string path = temporary(std::string("bars") + ending);
    EXPECT_NO_THROW(check_animation(path, most));
    EXPECT_NE(error_of([&] { check_animation(path, most * 1.01); }).find("use MP4, WebM or a series of pictures"),
              std::string::npos);
  }
}

// 24 pictures per second last 4 or 5 hundredths each, and a second together.
TEST(Film, RoundedDurationsAddUp) {
  const Frames frames{1, 1, 24, {}, {}, 1.0 / 24};
  int sum = 0;
  for (size_t i = 0; i < 24; ++i) {
    EXPECT_NEAR(frames.duration(i, 100, 2), 100.0 / 24, 1);
    sum += frames.duration(i, 100, 2);
  }
  EXPECT_EQ(sum, 100);
  EXPECT_EQ((Frames{1, 1, 2, {}, {}, 1e-4}.duration(0, 1000, 1)), 1);
}

// Browsers slow faster ones down.
TEST(Animation, AFrameLastsTwoHundredthsOrMore) {
  const std::string path = temporary("fast.gif");
  save_animation(path, bars(4, 64, 24), 2, 0.01);
  EXPECT_EQ(load_gif(path).hundredths, 2);
}

// 4096 colours, more than a palette has: red by column, green by row, blue of both.
TEST(Animation, PicturesOfManyColoursAreDitheredToTheirMeans) {
  constexpr int side = 64, block = 16;
  Image image(side, side, 3);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i)
      for (int c = 0; c < 3; ++c)
        image(j, i, c) = float(srgb_decode((c == 0 ? i : c == 1 ? j : (i + j) / 2.0) * 4 / 255));
  const std::string path = temporary("colours.gif");
  save_animation(path, {image, image}, 1, 1);
  const Gif gif = load_gif(path);
  ASSERT_EQ(gif.frames.size(), 2u);
  double worst = 0;
  for (int j = 0; j < side; j += block)
    for (int i = 0; i < side; i += block)
      for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (int y = j; y < j + block; ++y)
          for (int x = i; x < i + block; ++x)
            sum += gif.frames[0][size_t((y * side + x) * 3 + c)] - 255 * srgb_encode(double(image(y, x, c)));
        worst = std::max(worst, std::abs(sum) / (block * block));
      }
  // Error diffusion keeps the mean of a block but for what crosses its edges: the error of one pixel, up to half the
  // distance of the palette's colours (256 of them on a surface of 256² codes: 16), on 2·16 of its 256 pixels: 1.
  EXPECT_LT(worst, 1);
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
            "expected an animated file .gif or .webp or .mp4 or .webm, got a.png; change its extension");
  const std::string tall = temporary("tall.webp");
  EXPECT_EQ(error_of([&] {
              save_animation(tall, {Image(16384, 2, 1), Image(16384, 2, 1)}, 1, 1);
            }),
            tall + ": expected at most 16383 × 16383 pixels in a WebP, got 2 × 16384; use a larger pixel");
  EXPECT_FALSE(std::filesystem::exists(tall));
}

void expect_same_bytes(const std::string& ending) {
  const std::string a = temporary("a" + ending), b = temporary("b" + ending);
  for (const std::string& path : {a, b}) save_animation(path, bars(4, 64, 24), 2, 1.2);
  EXPECT_TRUE(read_text(a) == read_text(b)) << ending;
}

TEST(Animation, TheSamePicturesGiveTheSameBytes) {
  for (const char* ending : {".gif", ".webp"}) expect_same_bytes(ending);
}

// The PATH of this program, while it exists.
class SearchPath {
 public:
  explicit SearchPath(const std::string& path) : before_(std::getenv("PATH")) { setenv("PATH", path.c_str(), 1); }
  ~SearchPath() { setenv("PATH", before_.c_str(), 1); }
  SearchPath(const SearchPath&) = delete;

 private:
  std::string before_;
};

// A folder with a program ffmpeg that runs a script.
std::string fake_ffmpeg(const std::string& script) {
  const std::string path = make_file("ffmpeg", "#!/bin/sh\n" + script);
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return std::filesystem::path(path).parent_path();
}

TEST(Film, TheSamePicturesGiveTheSameBytes) {
  if (std::system("ffmpeg -version > /dev/null 2>&1") != 0) GTEST_SKIP() << "ffmpeg is not installed";
  for (const char* ending : {".mp4", ".webm"}) expect_same_bytes(ending);
}

TEST(Film, WithoutFfmpegItSaysWhatToInstallAndLeavesNothing) {
  const std::string path = temporary("a.mp4"), folder = std::filesystem::path(path).parent_path();
  const SearchPath search(folder);
  EXPECT_EQ(error_of([&] { save_animation(path, bars(2, 8, 8), 1, 1); }),
            "expected the program ffmpeg to write " + path +
                " with, got \"No such file or directory\"; install it (Debian: ffmpeg), or name a .webp or .gif");
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(Film, AnFfmpegWithoutTheEncoderIsRefused) {
  const std::string path = temporary("a.webm");
  const SearchPath search(fake_ffmpeg("echo ' V....D libx264   H.264'\n"));
  EXPECT_EQ(error_of([&] { check_animation(path); }),
            "expected an ffmpeg with the encoder libvpx-vp9 to write " + path +
                " with, got one without it; install one that has it (Debian: ffmpeg), or name a .webp or .gif");
}

TEST(Film, PassesOnWhatFfmpegSaysWhenItFails) {
  const std::string path = temporary("a.mp4");
  const SearchPath search(fake_ffmpeg("echo ' V....D libx264   H.264'\n"
                                      "[ $# -lt 3 ] && exit\necho 'no room' >&2; echo 'more' >&2; exit 1\n") +
                          ":" + std::getenv("PATH"));
  EXPECT_EQ(error_of([&] { save_animation(path, bars(2, 800, 800), 1, 1); }),  // more than a pipe holds
            "expected ffmpeg to write " + path + ", got \"no room\"; update ffmpeg, or name a .webp or .gif");
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(SeriesName, HasTwoOrMoreSignsForItsDigits) {
  EXPECT_EQ(series_path("out/view_####.png", 0), "out/view_0001.png");
  EXPECT_EQ(series_path("##.jpg", 122), "123.jpg");
  EXPECT_EQ(series_path("a##_###b.exr", 6), "a##_007b.exr");  // the last ones count
  for (const char* usual : {"try#2.png", "view.png", "a##/view.png", "####.gif", "a#b#.png"}) {
    EXPECT_FALSE(is_series_name(usual)) << usual;
    EXPECT_EQ(series_path(usual, 3), usual);
  }
}

}  // namespace
}  // namespace holotrace::test
