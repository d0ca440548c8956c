#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <ctime>

#include "holotrace/io/field/field_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/data_files.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::make_file;
using test::temporary;

// Every 8-bit code once, as linear light.
Image ramp(int channels) {
  Image image(16, 16, channels);
  for (size_t i = 0; i < image.values.size(); ++i) image.values[i] = float(srgb_decode(double(i % 256) / 255));
  return image;
}

TEST(ImageEnding, IsThatOfAFormatThatCanBeRead) {
  for (const char* name : {"a.png", "a.jpg", "A.JPEG", "a.exr", "a.hdr", "a.tif", "a.tiff", "a.webp", "a.bmp", "a.tga"})
    EXPECT_TRUE(has_image_ending(name)) << name;
  for (const char* name : {"a.npy", "a.h5", "a.toml", "png", "a.png/b"}) EXPECT_FALSE(has_image_ending(name)) << name;
}

TEST(ImageFile, SrgbHasItsStandardValues) {
  // IEC 61966-2-1: linear 0.18 has the code 0.4614, code 0.5 is linear 0.2140, to the digits given.
  EXPECT_NEAR(srgb_encode(0.18), 0.4614, 5e-5);
  EXPECT_NEAR(srgb_decode(0.5), 0.2140, 5e-5);
  for (double code : {0.0, 0.04, 0.041, 0.5, 1.0}) EXPECT_NEAR(srgb_encode(srgb_decode(code)), code, 1e-7);
}

TEST(ImageFile, EightBitCodesComeBackExactly) {
  for (int channels : {1, 3}) {
    const std::string path = temporary("i.png");
    const Image image = ramp(channels);
    save_image(path, image, 1, 8);
    const Image loaded = load_image(path);
    EXPECT_EQ(loaded.channels, channels);
    EXPECT_EQ(loaded.values, image.values);  // the same codes decode to the same values
  }
}

TEST(ImageFile, SixteenBitsKeepHalfAStep) {
  const std::string path = temporary("i.png");
  const Image image = ramp(3);
  save_image(path, image, 2, 16);
  const Image loaded = load_image(path);
  ASSERT_EQ(loaded.values.size(), image.values.size());
  for (size_t i = 0; i < image.values.size(); ++i)
    EXPECT_NEAR(loaded.values[i], image.values[i] / 2, 2.3 * 0.5 / 65535 + 1e-7);  // slope of the decoding ≤ 2.4/1.055
}

TEST(ImageFile, ValuesOutsideBlackAndWhiteAreClipped) {
  const std::string path = temporary("i.png");
  Image image(1, 3, 1);
  image.values = {-1, 5, std::nanf("")};
  save_image(path, image, 2, 8);
  EXPECT_EQ(load_image(path).values, (std::vector<float>{0, 1, 0}));
}

TEST(ImageFile, ExrKeepsRadiometricValues) {
  for (int channels : {1, 3}) {
    const std::string path = temporary("i.exr");
    Image image = ramp(channels);
    for (float& value : image.values) value *= 1234.5f;
    image.pitch = 8e-6;
    save_image(path, image, 1, 8);
    const Image loaded = load_image(path);
    EXPECT_EQ(loaded.channels, channels);
    EXPECT_EQ(loaded.values, image.values);
    EXPECT_EQ(loaded.pitch, 8e-6);
  }
}

TEST(ImageFile, TheSameImageGivesTheSameBytes) {
  for (const char* name : {".png", ".exr"}) {
    const std::string a = temporary(std::string("a") + name), b = temporary(std::string("b") + name);
    save_image(a, ramp(3), 1, 8);
    save_image(b, ramp(3), 1, 8);
    EXPECT_EQ(read_text(a), read_text(b));
    // Neither a time as text, such as "2001:02:03", nor a PNG chunk with a time: both would differ a second later.
    const std::time_t now = std::time(nullptr);
    EXPECT_EQ(read_text(a).find(fmt::format("{}:", 1900 + std::localtime(&now)->tm_year)), std::string::npos);
    EXPECT_EQ(read_text(a).find("tIME"), std::string::npos);
  }
}

TEST(ImageFile, PitchAndRecordComeBackFromEveryFormat) {
  for (const char* name : {"a.png", "a.jpg", "a.JPEG", "a.exr"}) {
    const std::string path = temporary(name);
    Image image(2, 3, 1);
    image.pitch = 6.4e-6 / 3;
    save_image(path, image, 1, 8, {{"a_2.png", 12}, {"ä.gif", 7}});
    EXPECT_EQ(load_image(path).pitch, image.pitch) << name;
    EXPECT_EQ(image_record(path), (FileRecord{{"a_2.png", 12}, {"ä.gif", 7}})) << name;
    // The bytes do not depend on the name, and a record goes with its file when that is renamed.
    const std::string other = temporary(std::string("b") + name);
    const std::string stem = std::filesystem::path(other).stem();
    save_image(other, image, 1, 8, {{stem + "_2.png", 12}, {"ä.gif", 7}});
    EXPECT_TRUE(read_text(other) == read_text(path)) << name;
    EXPECT_EQ(image_record(other), (FileRecord{{stem + "_2.png", 12}, {"ä.gif", 7}})) << name;
    save_image(path, Image(2, 3, 1), 1, 8);
    EXPECT_EQ(load_image(path).pitch, 0) << name;
    EXPECT_TRUE(image_record(path).empty()) << name;
  }
  EXPECT_TRUE(image_record(temporary("missing.png")).empty());
  EXPECT_TRUE(image_record(test::make_file("text.png", "no picture")).empty());
}

// One comment of a JPEG has at most 65533 bytes.
TEST(ImageFile, ALongRecordIsInSeveralCommentsOfAJpeg) {
  FileRecord record;
  for (int i = 0; i < 5000; ++i) record.emplace(fmt::format("a_sweep_{:04}.jpg", i), 1000 + i);
  const std::string path = temporary("a.jpg");
  save_image(path, Image(8, 8, 3), 1, 8, record);
  EXPECT_EQ(image_record(path), record);
}

// Libjpeg decodes it here; tests/python/test_pictures_out.py reads one by Pillow.
TEST(ImageFile, AJpegIsThePictureButForSmallErrors) {
  Image image(64, 64, 3);
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i)
      for (int c = 0; c < 3; ++c)
        image(j, i, c) = float(srgb_decode(0.5 + 0.4 * std::sin(0.1 * (c == 0 ? i : c == 1 ? j : i - j))));
  for (const int channels : {1, 3}) {
    const std::string path = temporary("a.jpg"), other = temporary("b.jpg");
    Image saved(64, 64, channels);
    for (size_t i = 0; i < saved.values.size(); ++i) saved.values[i] = 3 * image.values[channels == 3 ? i : 3 * i];
    save_image(path, saved, 3, 8);
    save_image(other, saved, 3, 8);
    EXPECT_TRUE(read_text(path) == read_text(other));
    const Image read = load_image(path);
    ASSERT_EQ(read.channels, channels);
    double sum = 0;
    for (size_t i = 0; i < read.values.size(); ++i)
      sum += std::pow(255 * (srgb_encode(double(read.values[i])) - srgb_encode(double(saved.values[i]) / 3)), 2);
    // Steps of the table of quality 95 are 2 to 12 codes; the first ones, of the long waves here, 2: 2/√12 = 0.6 from each
    // of three components, with weights of at most 1.8 (blue of Y′CbCr), and 0.3 from rounding: below 1.5.
    EXPECT_LT(std::sqrt(sum / double(read.values.size())), 1.5);
  }
}

TEST(ImageFile, FilesThatAreNotImagesAreRefused) {
  const std::string path = make_file("i.png", "only text");
  EXPECT_EQ(
      error_of([&] { load_image(path); }),
      path + ": expected an image, but it is not an image in a format known here; convert it to PNG, JPEG or EXR");
  const std::string none = temporary("none.png");
  EXPECT_EQ(error_of([&] { load_image(none); }),
            "expected an image at " + none + ", but there is no such file; check the path");
}

TEST(ImageFile, ATruncatedImageIsRefused) {
  const std::string path = temporary("i.png");
  Image noise(64, 64, 3);
  for (size_t i = 0; i < noise.values.size(); ++i) noise.values[i] = 0.5f + 0.5f * std::sin(float(i * i));
  save_image(path, noise, 1, 8);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  const std::string error = error_of([&] { load_image(path); });
  EXPECT_TRUE(error.starts_with(path + ": expected an image of 64 × 64 pixels, but it is truncated or damaged"))
      << error;
}

TEST(ImageFile, BytesThatOtherProgramsAddAfterAPictureAreAccepted) {
  const std::string path = temporary("i.png");
  save_image(path, ramp(3), 1, 8);
  const Image plain = load_image(path);
  std::ofstream(path, std::ios::binary | std::ios::app) << std::string(100, 'x');
  EXPECT_EQ(load_image(path).values, plain.values);
}

TEST(ImageFile, AFieldIsNoImage) {
  const std::string path = temporary("f.exr");
  save_field(path, Field({2, 2, 8e-6}, 532e-9));
  EXPECT_EQ(error_of([&] { load_image(path); }),
            path +
                ": expected an image, got a field (channels \"real\" and \"imag\"); give it to a command that takes "
                "a field");
}

TEST(ImageFile, BadRequestsAreRefused) {
  EXPECT_EQ(error_of([] { save_image("i.bmp", Image(1, 1, 1), 1, 8); }),
            "expected an image file .png or .jpg or .jpeg or .exr, got i.bmp; change its extension");
  EXPECT_EQ(error_of([] { save_image("i.jpg", Image(1, 1, 1), 1, 16); }),
            "expected 8 bits for the JPEG i.jpg, got 16; name a .png");
  const std::string path = temporary("wide.jpg");
  EXPECT_EQ(error_of([&] { save_image(path, Image(1, 65501, 1), 1, 8); }),
            path + ": expected at most 65500 × 65500 pixels in a JPEG, got 65501 × 1; name a .png");
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_EQ(error_of([] { save_image("i.png", Image(1, 1, 1), 0, 8); }),
            "expected a white level above 0 for i.png, got 0");
  EXPECT_EQ(error_of([] { save_image("i.png", Image(1, 1, 1), 1, 12); }), "expected 8 or 16 bits for i.png, got 12");
  EXPECT_EQ(error_of([] { save_image("i.png", Image(), 1, 8); }),
            "expected an image with pixels of 1 or 3 channels to save as i.png, got 0 × 0 of 1");
}

// Written by another program, with all filters of PNG: red 255·i/95, green 255·j/63, blue 7i + 13j, in sRGB.
TEST(ImageFile, APictureFromAnotherProgramIsRead) {
  const Image image = load_image(test::data_file("ramp.png"));
  ASSERT_EQ(image.nx, 96);
  ASSERT_EQ(image.ny, 64);
  ASSERT_EQ(image.channels, 3);
  const auto linear = [](int value) {  // IEC 61966-2-1
    const double s = value / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  };
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i) {
      ASSERT_NEAR(image(j, i, 0), linear(i * 255 / 95), 1e-5) << i << " " << j;
      ASSERT_NEAR(image(j, i, 1), linear(j * 255 / 63), 1e-5) << i << " " << j;
      ASSERT_NEAR(image(j, i, 2), linear((i * 7 + j * 13) % 256), 1e-5) << i << " " << j;
    }
}

// The same 24 × 16 codes in files of other programs: red 11·column, green 17·row, blue (7·column + 13·row) mod 256.
struct OtherFile {
  const char* name;
  int channels;
  double tolerance;  // [codes of 255]
};

TEST(ImageFile, EveryFormatIsReadAsItsProgramWroteIt) {
  // JPEG of quality 100 rounds its transform and its colours: some codes; four inks also their products.
  for (const OtherFile& file : {OtherFile{"rgb.jpg", 3, 3},
                                {"progressive.jpg", 3, 3},
                                {"grey.jpg", 1, 2},
                                {"cmyk.jpg", 3, 4},
                                {"rgb.tif", 3, 0},
                                {"rgba.tif", 3, 0},
                                {"grey.tif", 1, 0},
                                {"grey16.tif", 1, 0},
                                {"rgba.webp", 3, 0},
                                {"rgb.bmp", 3, 0},
                                {"grey.bmp", 1, 0},
                                {"rgb.tga", 3, 0},
                                {"runs.tga", 3, 0},
                                {"rgba.tga", 3, 0},
                                {"grey.tga", 1, 0},
                                {"rgba.png", 3, 0},
                                {"palette.png", 3, 0},
                                {"rgb.exr", 3, 0},
                                {"rgb.hdr", 3, 0}}) {
    const std::string path = test::data_file(std::string("pictures/") + file.name), extension = extension_of(path);
    const bool is_light = extension == ".exr" || extension == ".hdr";  // their numbers are the codes
    for (const ImageContent content : {ImageContent::data, ImageContent::colour}) {
      const Image image = load_image(path, content);
      ASSERT_EQ(image.nx, 24) << file.name;
      ASSERT_EQ(image.ny, 16) << file.name;
      ASSERT_EQ(image.channels, file.channels) << file.name;
      const bool is_grey = file.channels == 1 || std::string(file.name) == "palette.png";
      for (int j = 0; j < image.ny; ++j)
        for (int i = 0; i < image.nx; ++i)
          for (int c = 0; c < image.channels; ++c) {
            const int code = is_grey || c == 0 ? 11 * i : c == 1 ? 17 * j : (7 * i + 13 * j) % 256;
            const double value = double(image(j, i, c));
            const double read = is_light ? value : 255 * (content == ImageContent::colour ? srgb_encode(value) : value);
            ASSERT_NEAR(read, code, file.tolerance + 1e-4) << file.name << " " << i << " " << j << " " << c;
          }
    }
  }
}

TEST(ImageFile, AJpegThatEndsEarlyIsRefused) {
  const std::string path = test::data_file("pictures/rgb.jpg"), bytes = read_text(path);
  const std::string cut = bytes.substr(0, bytes.size() * 3 / 4) + "\xFF\xD9";  // its marker of the end
  EXPECT_EQ(error_of([&] { decode_image(cut.data(), cut.size(), path); }),
            path + ": expected an image of 24 × 16 pixels, but it is truncated or damaged");
}

TEST(ImageFile, EveryFormatIsReadFromMemoryAndRefusedWhenCut) {
  for (const char* name : {"rgb.jpg", "progressive.jpg", "rgb.tif", "rgba.webp", "rgb.bmp", "rgb.tga", "runs.tga",
                           "rgba.png", "rgb.exr", "rgb.hdr"}) {
    const std::string path = test::data_file(std::string("pictures/") + name), bytes = read_text(path);
    const Image image = load_image(path);
    EXPECT_EQ(decode_image(bytes.data(), bytes.size(), path).values, image.values) << name;
    // Without its last tenth no file has all of its pixels.
    const std::string error = error_of([&] { decode_image(bytes.data(), bytes.size() * 9 / 10, path); });
    EXPECT_TRUE(
        error == path + ": expected an image of 24 × 16 pixels, but it is truncated or damaged" ||
        error.starts_with(path + ": expected an image, but it is not an image"))  // TIFF: its header is at the end
        << name << ": " << error;
    EXPECT_TRUE(error.find("not an image") == std::string::npos || std::string(name) == "rgb.tif") << name;
  }
}

// Rows from the bottom and columns from the right, as Radiance's "+Y 2 -X 2" says.
TEST(ImageFile, RadiancePicturesMayBeginAtAnyCorner) {
  std::string pixels;
  for (const char value : {2, 3, 4, 5}) pixels += std::string{value, value, value, char(136)};
  const auto read = [&](const std::string& size) {
    const std::string bytes = "#?RADIANCE\n\n" + size + "\n" + pixels;
    Image image = decode_image(bytes.data(), bytes.size(), "p.hdr");
    return std::vector<float>{image(0, 0), image(0, 1), image(1, 0), image(1, 1)};
  };
  EXPECT_EQ(read("-Y 2 +X 2"), (std::vector<float>{2, 3, 4, 5}));
  EXPECT_EQ(read("+Y 2 +X 2"), (std::vector<float>{4, 5, 2, 3}));
  EXPECT_EQ(read("-Y 2 -X 2"), (std::vector<float>{3, 2, 5, 4}));
}

// Before there were runs of components, a pixel (1, 1, 1, n) meant n times the pixel before it; the next such one 256·n
// times. After 3, 88 + 256·2 repetitions; after 5, 9 more, counted from the start again.
TEST(ImageFile, OldRadiancePicturesRepeatPixels) {
  const auto pixel = [](int value, int last) { return std::string{char(value), char(value), char(value), char(last)}; };
  const std::string bytes =
      "#?RADIANCE\n\n-Y 1 +X 611\n" + pixel(3, 136) + pixel(1, 88) + pixel(1, 2) + pixel(5, 136) + pixel(1, 9);
  const Image image = decode_image(bytes.data(), bytes.size(), "p.hdr");
  ASSERT_EQ(image.nx, 611);
  for (int i = 0; i < 611; ++i) ASSERT_EQ(image(0, i), i < 601 ? 3 : 5) << i;
}

TEST(ImageFile, SmallerPicturesAreMeansAndLargerOnesLinear) {
  Image steps(1, 4, 1);
  steps.values = {0, 0, 8, 8};
  // Triangles of half width 2 about 0.5 and 2.5, the ends repeated: weights 1/8 3/8 3/8 1/8 of {0, 0, 0, 8}.
  EXPECT_EQ(resample_image(steps, 2, 1).values, (std::vector<float>{1, 7}));
  // Twice as many: at −0.25, 0.25, … of the old places.
  EXPECT_EQ(resample_image(steps, 8, 1).values, (std::vector<float>{0, 0, 0, 2, 6, 8, 8, 8}));
  Image colours(3, 1, 3);
  colours.values = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  EXPECT_EQ(resample_image(colours, 1, 3).values, colours.values);
  const Image one = resample_image(colours, 1, 1);
  for (int c = 0; c < 3; ++c) EXPECT_FLOAT_EQ(one(0, 0, c), 4.0F + float(c));  // the weights are symmetric
}

TEST(ImageFile, StokesParametersAreLayersOfAnExr) {
  std::array<Image, 4> parameters;
  for (size_t k = 0; k < 4; ++k) {
    parameters[k] = Image(2, 3, 3);
    for (size_t i = 0; i < 18; ++i) parameters[k].values[i] = float(i) - 10 * float(k);
  }
  const std::string path = temporary("stokes.exr");
  save_stokes(path, parameters);
  EXPECT_EQ(load_image(path).values, parameters[0].values) << "what a viewer shows";
  const std::string bytes = read_text(path);
  for (const char* name : {"S1.R", "S2.G", "S3.B"}) EXPECT_NE(bytes.find(name), std::string::npos) << name;
  EXPECT_EQ(error_of([&] { save_stokes("a.png", parameters); }),
            "a.png: expected a picture .exr for Stokes parameters");
}

}  // namespace
}  // namespace holotrace
