// Kinds of pictures that few programs write, byte by byte as their formats' specifications have them.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "holotrace/io/picture/formats/formats.h"
#include "holotrace/io/picture/image_file.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

std::string number(uint32_t value, int bytes) {  // low byte first
  std::string text;
  for (int k = 0; k < bytes; ++k) text += char(value >> (8 * k) & 0xFF);
  return text;
}

// Light of a code of sRGB.
double light(int code) {
  const double v = code / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

// The name counts for TGA alone, which has no signature.
Image decoded(const std::string& bytes) { return decode_image(bytes.data(), bytes.size(), "picture.tga"); }

void expect_codes(const Image& image, const std::vector<std::vector<int>>& pixels) {
  ASSERT_EQ(size_t(image.nx) * size_t(image.ny), pixels.size());
  for (size_t i = 0; i < pixels.size(); ++i)
    for (int c = 0; c < image.channels; ++c) {
      const int code = pixels[i][std::min(size_t(c), pixels[i].size() - 1)];
      EXPECT_NEAR(image.values[i * size_t(image.channels) + size_t(c)], light(code), 1e-6) << i << " " << c;
    }
}

struct Tag {
  uint16_t id;
  std::vector<uint32_t> values;  // as LONG
};

// A TIFF of one page: the pixels, then the directory, then lists of several values.
std::string tiff(const std::string& pixels, const std::vector<Tag>& tags) {
  const size_t directory = 8 + pixels.size();
  std::string entries = number(uint32_t(tags.size()), 2), lists;
  const size_t after = directory + 2 + 12 * tags.size() + 4;
  for (const Tag& tag : tags) {
    entries += number(tag.id, 2) + number(4, 2) + number(uint32_t(tag.values.size()), 4);
    if (tag.values.size() == 1) {
      entries += number(tag.values[0], 4);
      continue;
    }
    entries += number(uint32_t(after + lists.size()), 4);
    for (const uint32_t value : tag.values) lists += number(value, 4);
  }
  return "II" + number(42, 2) + number(uint32_t(directory), 4) + pixels + entries + number(0, 4) + lists;
}

TEST(PictureVariants, ATiffOfTiles) {
  // 24 × 16 pixels in two tiles of 16 × 16; the right half of the second one lies outside.
  std::string pixels;
  std::vector<std::vector<int>> codes;
  for (int tile = 0; tile < 2; ++tile)
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) pixels += char(8 * (16 * tile + x) % 256 + y % 8);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 24; ++x) codes.push_back({8 * x + y % 8});
  const auto file = [&](uint32_t side) {
    return tiff(pixels, {{256, {24}},
                         {257, {16}},
                         {258, {8}},
                         {259, {1}},
                         {262, {1}},
                         {277, {1}},
                         {322, {side}},
                         {323, {side}},
                         {324, {8, 8 + 256}},
                         {325, {256, 256}}});
  };
  expect_codes(decoded(file(16)), codes);
  // One tile of 2^18 × 2^18 pixels would take 64 GB.
  EXPECT_THROW(decoded(file(1 << 18)), Error);
}

TEST(PictureVariants, ATiffWithItsColoursApart) {
  std::string pixels;
  for (int c = 0; c < 3; ++c)
    for (int i = 0; i < 6; ++i) pixels += char(100 * c + 10 * i);
  std::vector<std::vector<int>> codes;
  for (int i = 0; i < 6; ++i) codes.push_back({10 * i, 100 + 10 * i, 200 + 10 * i});
  expect_codes(decoded(tiff(pixels, {{256, {3}},
                                     {257, {2}},
                                     {258, {8, 8, 8}},
                                     {259, {1}},
                                     {262, {2}},
                                     {273, {8, 14, 20}},
                                     {277, {3}},
                                     {278, {2}},
                                     {279, {6, 6, 6}},
                                     {284, {2}}})),
               codes);
}

TEST(PictureVariants, ATiffWhoseZeroIsWhite) {
  expect_codes(decoded(tiff(std::string("\0\x40\xFF\x80", 4), {{256, {2}},
                                                               {257, {2}},
                                                               {258, {8}},
                                                               {259, {1}},
                                                               {262, {0}},
                                                               {273, {8}},
                                                               {277, {1}},
                                                               {278, {2}},
                                                               {279, {4}}})),
               {{255}, {255 - 0x40}, {0}, {255 - 0x80}});
}

// A BMP of the header with 40 bytes. @param behind  palette or masks
std::string bmp(int columns, int rows, int bits, int compression, const std::string& behind,
                const std::string& pixels) {
  const uint32_t begin = uint32_t(14 + 40 + behind.size());
  return "BM" + number(uint32_t(begin + pixels.size()), 4) + number(0, 4) + number(begin, 4) + number(40, 4) +
         number(uint32_t(columns), 4) + number(uint32_t(rows), 4) + number(1, 2) + number(uint32_t(bits), 2) +
         number(uint32_t(compression), 4) + number(uint32_t(pixels.size()), 4) + std::string(16, '\0') + behind +
         pixels;
}

TEST(PictureVariants, ABmpInRuns) {
  std::string palette;
  for (uint32_t i = 0; i < 256; ++i) palette += number(i * 0x010101U, 4);
  // The lower row: two runs. The upper one: three single pixels with a byte of padding, and a run of one.
  const std::string runs(
      "\2\x0A\2\x14\0\0"
      "\0\3\x1E\x28\x32\0\1\x3C\0\1",
      16);
  expect_codes(decoded(bmp(4, 2, 8, 1, palette, runs)), {{30}, {40}, {50}, {60}, {10}, {10}, {20}, {20}});
}

TEST(PictureVariants, ABmpOf16BitsFromTheTop) {
  const std::string masks = number(0xF800, 4) + number(0x07E0, 4) + number(0x001F, 4);
  const std::string pixels = number(0xF800, 2) + number(0x07E0, 2) + number(0x001F, 2) + number(0xFFFF, 2);
  expect_codes(decoded(bmp(2, -2, 16, 3, masks, pixels)), {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}});
}

// A TGA from its upper left corner.
std::string tga(int kind, int colours, int columns, int rows, int bits, const std::string& behind) {
  return number(0, 1) + number(colours > 0, 1) + number(uint32_t(kind), 1) + number(0, 2) +
         number(uint32_t(colours), 2) + number(colours > 0 ? 24 : 0, 1) + number(0, 4) + number(uint32_t(columns), 2) +
         number(uint32_t(rows), 2) + number(uint32_t(bits), 1) + number(0x20, 1) + behind;
}

TEST(PictureVariants, ATgaWithAPaletteAndOneOf16Bits) {
  const std::string palette(
      "\0\0\xFF"
      "\0\xFF\0"
      "\xFF\x80\0",
      9);  // blue, green, red
  expect_codes(decoded(tga(1, 3, 3, 1, 8, palette + std::string("\2\0\1", 3))),
               {{0, 0x80, 255}, {255, 0, 0}, {0, 255, 0}});
  expect_codes(decoded(tga(2, 0, 2, 1, 16, number(0x7C00, 2) + number(0x03FF, 2))), {{255, 0, 0}, {0, 255, 255}});
}

TEST(PictureVariants, ARadiancePictureInRunsOfItsFirstKind) {
  // Nine times the pixel before: (1, 1, 1, 9). Its value is (128, 64, 32)/256 · 2^(129 − 128).
  const Image image = decoded("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 10\n\x80\x40\x20\x81\1\1\1\x09");
  ASSERT_EQ(image.nx, 10);
  for (int i = 0; i < 10; ++i)
    for (int c = 0; c < 3; ++c)  // some readers take the middle of a step, half of 1/128, for its value
      EXPECT_NEAR(image(0, i, c), std::pow(0.5, c), 0.5 / 128) << i << " " << c;
}

TEST(PictureVariants, ARadiancePictureHasRowsAndColumns) {
  for (const std::string size : {"-Y 0 +X 10", "-Y 1 +X 0", "-Y 1 +X", "-Y -1 +X 10"})
    EXPECT_THROW(decoded("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + size + "\n\x80\x40\x20\x81\1\1\1\x09"), Error)
        << size;
}

TEST(PictureVariants, AGreyExrWithAlphaIsItsGrey) {
  const std::string path = test::temporary("grey.exr");
  const float samples[] = {0.25F, 1, 0.75F, 0.5F};  // Y, A of two pixels
  write_exr(path, {2, 1, {"Y", "A"}, {}, {}}, samples);
  const Image image = load_image(path);
  ASSERT_EQ(image.channels, 1);
  EXPECT_EQ(image.values, (std::vector<float>{0.25F, 0.75F}));
}

}  // namespace
}  // namespace holotrace
