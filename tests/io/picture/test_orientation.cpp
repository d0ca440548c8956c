// Pictures that tell how they stand, and the exponent of their samples.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "holotrace/io/picture/image_file.h"
#include "support/data_files.h"
#include "support/png.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::big_endian;
using test::make_file;
using test::temporary;

std::string little(uint32_t value, int bytes) {
  std::string text;
  for (int k = 0; k < bytes; ++k) text += char(value >> (8 * k) & 0xFF);
  return text;
}

// EXIF data with one entry before the orientation, as cameras write it.
std::string exif(int orientation, bool is_little) {
  const auto two = [&](uint32_t value) { return is_little ? little(value, 2) : big_endian(value).substr(2); };
  const auto four = [&](uint32_t value) { return is_little ? little(value, 4) : big_endian(value); };
  return (is_little ? "II" : "MM") + two(42) + four(8) + two(2) + two(0x10F) + two(2) + four(4) +
         std::string("abc\0", 4) + two(0x112) + two(3) + four(1) + two(uint32_t(orientation)) + two(0) + four(0);
}

// The PNG with chunks before its pixels, or after them (before IEND), and without its own word on colours.
void set_chunks(const std::string& path, const std::vector<std::string>& chunks, const char* before = "IDAT") {
  const std::string png = read_text(path);
  std::string bytes = png.substr(0, 8);
  bool is_first = true;
  test::for_each_chunk(png, [&](const std::string& type, const std::string&, size_t begin, size_t end) {
    if (type == before && is_first)
      for (const std::string& chunk : chunks)
        bytes += big_endian(uint32_t(chunk.size() - 4)) + chunk + big_endian(test::crc_of(chunk));
    is_first = is_first && type != before;
    if (type != "sRGB" && type != "gAMA" && type != "cHRM") bytes += png.substr(begin, end - begin);
  });
  std::ofstream(path, std::ios::binary) << bytes;
}

// Two rows of three pixels, 0 1 2 and 3 4 5 in the file.
std::string six_pixels(const std::string& name) {
  Image image(2, 3, 1);
  for (int i = 0; i < 6; ++i) image.values[size_t(i)] = float(i) / 5;
  const std::string path = temporary(name);
  save_image(path, image, 1, 16);
  return path;
}

// How they stand by the definition of TIFF 6.0: "the 0th row represents the visual right-hand side of the image, and the
// 0th column represents the visual top" is 6.
const std::vector<std::vector<std::vector<int>>> upright{
    {{0, 1, 2}, {3, 4, 5}},   {{2, 1, 0}, {5, 4, 3}},   {{5, 4, 3}, {2, 1, 0}},   {{3, 4, 5}, {0, 1, 2}},
    {{0, 3}, {1, 4}, {2, 5}}, {{3, 0}, {4, 1}, {5, 2}}, {{5, 2}, {4, 1}, {3, 0}}, {{2, 5}, {1, 4}, {0, 3}}};

void expect_upright(const Image& image, int orientation) {
  const auto& rows = upright[size_t(orientation - 1)];
  ASSERT_EQ(image.ny, int(rows.size())) << orientation;
  ASSERT_EQ(image.nx, int(rows[0].size())) << orientation;
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i)
      EXPECT_NEAR(image(j, i), rows[size_t(j)][size_t(i)] / 5.0, 1e-4) << orientation << ": " << j << " " << i;
}

TEST(PictureOrientation, APngStandsAsItsExifSays) {
  for (int orientation = 1; orientation <= 8; ++orientation)
    for (const bool is_little : {false, true}) {
      for (const char* before :
           {"IDAT", "IEND"}) {  // the PNG specification lets eXIf stand on either side of the pixels
        const std::string path = six_pixels("turned.png");
        set_chunks(path, {"eXIf" + exif(orientation, is_little)}, before);
        expect_upright(load_image(path), orientation);
      }
    }
}

// The pixels of a photograph in tests/data_files do not change; its marker does.
TEST(PictureOrientation, AJpegStandsAsItsExifSays) {
  const std::string bytes = read_text(test::data_file("pictures/rgb.jpg"));
  const Image as_it_is = load_image(test::data_file("pictures/rgb.jpg"));
  const std::string data = std::string("Exif\0\0", 6) + exif(6, false);
  const std::string marker = "\xFF\xE1" + big_endian(uint32_t(data.size() + 2)).substr(2) + data;
  const Image turned = load_image(make_file("turned.jpg", bytes.substr(0, 2) + marker + bytes.substr(2)));
  ASSERT_EQ(turned.nx, as_it_is.ny);
  ASSERT_EQ(turned.ny, as_it_is.nx);
  for (int j = 0; j < turned.ny; ++j)
    for (int i = 0; i < turned.nx; ++i)
      for (int c = 0; c < 3; ++c) EXPECT_EQ(turned(j, i, c), as_it_is(as_it_is.ny - 1 - i, j, c));
}

TEST(PictureOrientation, ATiffStandsAsItsTagSays) {
  for (int orientation = 1; orientation <= 8; ++orientation)
    for (const uint32_t photometric : {1U, 3U}) {  // samples as they are; a palette, which libtiff converts
      std::string palette;
      for (int channel = 0; channel < 3; ++channel)
        for (int code = 0; code < 256; ++code) palette += little(uint32_t(code * 257), 2);
      std::string pixels;
      for (int i = 0; i < 6; ++i) pixels += char(51 * i);
      const auto entry = [](uint32_t tag, uint32_t type, uint32_t count, uint32_t value) {
        return little(tag, 2) + little(type, 2) + little(count, 4) + little(value, 4);
      };
      const uint32_t directory = 8 + uint32_t(pixels.size() + palette.size());
      std::string entries = entry(256, 4, 1, 3) + entry(257, 4, 1, 2) + entry(258, 3, 1, 8) + entry(259, 3, 1, 1) +
                            entry(262, 3, 1, photometric) + entry(273, 4, 1, 8) +
                            entry(274, 3, 1, uint32_t(orientation)) + entry(277, 3, 1, 1) + entry(278, 4, 1, 2) +
                            entry(279, 4, 1, 6);
      if (photometric == 3) entries += entry(320, 3, 768, 14);
      const std::string path =
          make_file("turned.tif", "II*" + std::string(1, '\0') + little(directory, 4) + pixels + palette +
                                      little(photometric == 3 ? 11 : 10, 2) + entries + little(0, 4));
      expect_upright(load_image(path, ImageContent::data), orientation);
    }
}

TEST(PictureOrientation, OfOtherNumbersAndDamagedDataIsNone) {
  for (const std::string& data :
       {exif(0, true), exif(9, true), exif(6, true).substr(0, 20), std::string("II*\0\x09\0\0\0", 8),
        std::string("II*\0\xFF\xFF", 6), std::string("MM\0*\xFF\xFF\xFF\xF0", 8)}) {
    const std::string path = six_pixels("damaged.png");
    set_chunks(path, {"sRGB" + std::string(1, '\0'), "eXIf" + data});
    expect_upright(load_image(path), 1);
  }
}

// PNG specification: light = sample^(1/gamma), unless sRGB or a profile says more. 1/2.2 is what programs write for sRGB.
TEST(PictureGamma, APngIsDecodedByItsOwnExponent) {
  const std::string path = six_pixels("gamma.png");
  const Image codes = load_image(path, ImageContent::data);
  const auto with = [&](const std::vector<std::string>& chunks) {
    set_chunks(path, chunks);
    return load_image(path);
  };
  const auto gama = [](double gamma) { return "gAMA" + big_endian(uint32_t(std::lround(gamma * 1e5))); };
  const Image linear = with({gama(1)}), square = with({gama(0.5)}), usual = with({gama(0.45455)}),
              srgb = with({"sRGB" + std::string(1, '\0'), gama(1)});
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(linear.values[i], codes.values[i], 1e-6);
    EXPECT_NEAR(square.values[i], std::pow(codes.values[i], 2), 1e-6);
    EXPECT_NEAR(usual.values[i], double(i) / 5, 1e-4);
    EXPECT_NEAR(srgb.values[i], double(i) / 5, 1e-4);
  }
  set_chunks(path, {gama(1)});
  EXPECT_NEAR(load_image(path, ImageContent::data).values[2], codes.values[2], 1e-6);  // numbers stay as they are
}

}  // namespace
}  // namespace holotrace
