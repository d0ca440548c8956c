#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "holotrace/io/files/file.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "holotrace/io/picture/picture_input.h"
#include "support/error_of.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::make_file;
using test::temporary;

std::string bytes_saved(const std::string& name, const PanelImage& image) {
  const std::string path = temporary(name);
  save_panel_image(path, image);
  return read_text(path);
}

std::string from_bytes(const std::vector<int>& bytes) { return {bytes.begin(), bytes.end()}; }

// Byte by byte by Microsoft's description of BITMAPFILEHEADER and BITMAPINFOHEADER: rows from the bottom up, each of whole
// four bytes, colours in the order blue, green, red.
TEST(PanelImageFile, BmpHasTheBytesOfItsDescription) {
  const PanelImage grey{3, 2, 1, 8, {1, 2, 3, 4, 5, 6}};
  const std::string bytes = bytes_saved("grey.bmp", grey);
  EXPECT_EQ(bytes.substr(0, 54),
            from_bytes({'B', 'M', 0x3E, 0x04, 0, 0, 0, 0, 0, 0, 0x36, 0x04, 0, 0,        // 1086 bytes, pixels at 1078
                        40,  0,   0,    0,    3, 0, 0, 0, 2, 0, 0,    0,    1, 0, 8, 0,  // one plane of 8 bits
                        0,   0,   0,    0,    8, 0, 0, 0, 0, 0, 0,    0,    0, 0, 0, 0,  // not compressed
                        0,   1,   0,    0,    0, 0, 0, 0}));                             // 256 colours
  for (int grey_level = 0; grey_level < 256; ++grey_level)
    EXPECT_EQ(bytes.substr(size_t(54 + 4 * grey_level), 4), from_bytes({grey_level, grey_level, grey_level, 0}));
  EXPECT_EQ(bytes.substr(1078), from_bytes({4, 5, 6, 0, 1, 2, 3, 0}));

  const PanelImage colour{1, 2, 3, 8, {1, 2, 3, 4, 5, 6}};
  const std::string coloured = bytes_saved("colour.bmp", colour);
  EXPECT_EQ(coloured.substr(28, 2), from_bytes({24, 0}));
  EXPECT_EQ(coloured.substr(54), from_bytes({6, 5, 4, 0, 3, 2, 1, 0}));
}

// Our readers are other programs' for PNG and TIFF: libpng and libtiff.
TEST(PanelImageFile, PicturesComeBackAsSaved) {
  for (const std::string ending : {".png", ".bmp", ".tif", ".tiff"})
    for (const int channels : {1, 3})
      for (const int bits : {8, 16}) {
        if (ending == ".bmp" && bits == 16) continue;
        PanelImage image{5, 3, channels, bits, {}};
        for (int i = 0; i < 15 * channels; ++i) image.values.push_back(uint16_t(bits == 8 ? 5 * i : 1400 * i));
        const std::string path = temporary("p" + ending);
        save_panel_image(path, image);
        const std::optional<Picture> picture = read_picture(path);
        ASSERT_TRUE(picture && picture->columns == 5 && picture->rows == 3) << ending;
        ASSERT_EQ(picture->channels.size(), size_t(channels)) << ending;
        EXPECT_EQ(picture->type, bits == 8 ? SampleType::bits_8 : SampleType::bits_16);
        std::visit(
            [&](const auto& samples) {
              EXPECT_EQ((std::vector<uint16_t>(samples.begin(), samples.end())), image.values) << ending;
            },
            picture->samples);
      }
}

// The header as numpy.lib.format describes it.
TEST(PanelImageFile, TablesAreThoseOfNumPyAndSantec) {
  const std::string bytes = bytes_saved("t.npy", {2, 3, 1, 16, {1, 2, 3, 4, 5, 1023}});
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  EXPECT_NE(bytes.find("{'descr': '<u2', 'fortran_order': False, 'shape': (3, 2), }"), std::string::npos);
  EXPECT_EQ(bytes.size(), 128U + 12U);
  EXPECT_EQ(bytes.substr(128), from_bytes({1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 0xFF, 0x03}));
  EXPECT_NE(bytes_saved("t.npy", {1, 1, 3, 8, {1, 2, 3}}).find("'|u1', 'fortran_order': False, 'shape': (1, 1, 3)"),
            std::string::npos);
  EXPECT_EQ(bytes_saved("t.csv", {2, 3, 1, 16, {1, 2, 3, 4, 5, 1023}}), "Y/X,0,1\n0,1,2\n1,3,4\n2,5,1023\n");
}

TEST(PanelImageFile, TablesOfOtherProgramsAreRead) {
  const auto read = [](const std::string& text) { return load_panel_table(make_file("t.csv", text)); };
  for (const char* text :
       {"Y/X,0,1\n0,1,2\n1,3,1023\n", "1,2\n3,1023\n", "# levels\n1;2\r\n3;1023\r\n", "1 2\n\n3\t1023"}) {
    const PanelTable table = read(text);
    EXPECT_EQ(std::vector<double>(table.values.values.begin(), table.values.values.end()),
              (std::vector<double>{1, 2, 3, 1023}))
        << text;
    EXPECT_FALSE(table.are_floats);
  }
  for (const auto& [text, words] : {std::pair{"1,2\n3\n", ":2: expected 2 values, as in the first line, got 1"},
                                    {"1,2\n3,x\n", ":2: expected numbers, got \"3,x\""},
                                    {"Y/X,0\n1,5\n", ":2: expected the row 0, got 1"},
                                    {"Y/X,0\n", ": expected a table of levels, got no numbers"},
                                    {"Y/X\n0\n", ":2: expected levels behind the number of the row, got none"},
                                    {"Y/X\n,\n", ": expected a table of levels, got no numbers"},
                                    {"1,2\n,\n", ":2: expected numbers, got \",\""},
                                    {"1,2,3\n4,,6\n", ":2: expected numbers, got \"4,,6\""}})
    EXPECT_NE(error_of([&] { read(text); }).find(words), std::string::npos) << text << error_of([&] { read(text); });

  // [[1, 2, 3]] as int64, [[1], [2]] in Fortran order as float64, and a type that holds no numbers.
  const auto npy = [](const std::string& dictionary, const std::string& data) {
    std::string header = dictionary;
    header.resize(117, ' ');
    return make_file("t.npy", std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + "\n" + data);
  };
  const PanelTable whole =
      load_panel_table(npy("{'descr': '<i8', 'fortran_order': False, 'shape': (1, 3), }",
                           from_bytes({1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0})));
  EXPECT_EQ(whole.values.nx, 3);
  EXPECT_EQ(whole.values(0, 2), 3);
  const PanelTable floats =
      load_panel_table(npy("{'descr': '<f4', 'fortran_order': True, 'shape': (2, 2), }",
                           from_bytes({0, 0, 0x80, 0x3F, 0, 0, 0, 0x40, 0, 0, 0x40, 0x40, 0, 0, 0x80, 0x40})));
  EXPECT_TRUE(floats.are_floats);
  EXPECT_EQ(floats.values(0, 1), 3);  // 1, 2 are the first column
  EXPECT_NE(error_of([&] {
              load_panel_table(npy("{'descr': '<c8', 'fortran_order': False, 'shape': (1, 1), }", "12345678"));
            }).find("expected levels as whole numbers, or phases as floats, got the type '<c8'"),
            std::string::npos);
  EXPECT_NE(error_of([&] {
              load_panel_table(npy("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }", "1234"));
            }).find("expected 16 bytes of numbers for shape (2, 2), got 4"),
            std::string::npos);
}

TEST(PanelImageFile, LevelTablesOfMakersAreRead) {
  const auto read = [](const std::string& text) { return load_level_table(make_file("t.lut", text)); };
  const std::vector<uint16_t> values{0, 512, 4095};
  for (const char* text :
       {"0\n512\n4095\n", "0 0\n1 512\n2 4095\n", "grey;voltage\n0;0\n1;512\n2;4095\n", "0\t0\r\n1\t512\r\n2\t4095"})
    EXPECT_EQ(read(text), values) << text;
  for (const auto& [text, words] :
       {std::pair{"0 0\n2 5\n", ":2: expected the grey 1, got 2; give a line for each grey"},
        {"0.5\n", ":1: expected a whole number of 0 to 65535, got 0.5"},
        {"70000\n", ":1: expected a whole number of 0 to 65535, got 70000"},
        {"1 2 3\n", ":1: expected a value, or a grey and its value, got 3 numbers"},
        {",\n", ": expected a level table, got no numbers"},
        {"0\n;;\n", ":2: expected numbers, got \";;\""},
        {"", ": expected a level table, got no numbers"}})
    EXPECT_NE(error_of([&] { read(text); }).find(words), std::string::npos) << text;
}

TEST(PanelImageFile, CorrectionsAreCycles) {
  for (const auto& [bits, full] : {std::pair{8, 256.0F}, {16, 65536.0F}}) {
    const std::string path = temporary("c.tif");
    save_panel_image(path, {2, 1, 1, bits, {0, 200}});
    const Array2D<float> cycles = load_correction(path, 256);
    EXPECT_EQ(cycles.values[0], 0);
    EXPECT_EQ(cycles.values[1], 200 / full);
  }
  const std::string coloured = temporary("c.bmp");
  save_panel_image(coloured, {1, 1, 3, 8, {1, 2, 3}});
  EXPECT_NE(error_of([&] {
              load_correction(coloured, 256);
            }).find("expected a grey correction, got a coloured pixel at row 0, column 0"),
            std::string::npos);
  const std::string whole = temporary("c.npy");
  save_panel_image(whole, {1, 1, 1, 8, {3}});
  EXPECT_NE(error_of([&] { load_correction(whole, 256); }).find("expected phases in radians as floats"),
            std::string::npos);
}

// Santec's own corrections: levels of a panel of 1024.
TEST(PanelImageFile, CorrectionsMayBeLevels) {
  const Array2D<float> cycles = load_correction(make_file("c.csv", "Y/X,0,1\n0,256,1023\n"), 1024);
  EXPECT_EQ(cycles.values[0], 0.25F);
  EXPECT_EQ(cycles.values[1], 1023 / 1024.0F);
  EXPECT_NE(error_of([&] { load_correction(make_file("c.jpg", "any"), 256); }).find("without loss, got a JPEG"),
            std::string::npos);
}

TEST(PanelImageFile, ThreeChannelsOfNumPyComeBack) {
  const std::string path = temporary("c.npy");
  save_panel_image(path, {2, 1, 3, 8, {1, 2, 3, 4, 5, 6}});
  const PanelTable table = load_panel_table(path);
  EXPECT_EQ(table.channels, 3);
  EXPECT_EQ(std::vector<double>(table.values.values.begin(), table.values.values.end()),
            (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_TRUE(is_panel_table(path));
  EXPECT_FALSE(is_panel_table(make_file("f.npy", std::string("\x93NUMPY\x01\x00\x46\x00", 10) + "{'descr': '<c8', ")));
}

// Only metadata of this program are replaced.
TEST(PanelImageFile, MetadataOfOthersAreNotOurs) {
  const std::string path = make_file("p.bmp", "any");
  write_text(sidecar_path(path), R"({"kind": 1})");
  EXPECT_TRUE(record_beside(path).empty());
  write_text(sidecar_path(path), R"({"kind": "panel-image"})");
  EXPECT_EQ(record_beside(path), (FileRecord{{"p.bmp.json", 23}}));
}

TEST(PanelImageFile, WhatAFormatCannotHoldIsRefused) {
  EXPECT_EQ(error_of([] {
              save_panel_image("p.jpg", {1, 1, 1, 8, {0}});
            }),
            "expected a file .png, .bmp, .tif, .npy or .csv for a panel, got p.jpg; change its extension");
  EXPECT_NE(error_of([] {
              save_panel_image("p.bmp", {1, 1, 1, 16, {0}});
            }).find("expected values of 8 bits for the BMP"),
            std::string::npos);
  EXPECT_NE(error_of([] {
              save_panel_image("p.csv", {1, 1, 3, 8, {0, 0, 0}});
            }).find("expected one channel for the table"),
            std::string::npos);
}

// A series replaces that of an earlier call, and files of others stay.
TEST(PanelImageFile, ASeriesReplacesItsEarlierFiles) {
  const std::string folder = temporary("series");
  std::filesystem::create_directories(folder);
  const auto save = [&](size_t count) {
    const std::vector<PanelImage> images(count, PanelImage{1, 1, 1, 8, {1}});
    return write_together(folder + "/p.bmp", record_beside(folder + "/p.bmp"), [&](const OutputSet& set) {
      save_panel_images(set, "p.bmp", images, {{"flip", "x"}});
    });
  };
  EXPECT_TRUE(save(3).empty());
  EXPECT_TRUE(save(3).empty());
  std::ofstream(folder + "/mine.txt") << "mine";
  EXPECT_TRUE(save(1).empty());
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename().string());
  EXPECT_EQ(names, (std::set<std::string>{"mine.txt", "p.bmp", "p.bmp.json"}));
  EXPECT_NE(read_text(folder + "/p.bmp.json").find("\"flip\": \"x\""), std::string::npos);
}

}  // namespace
}  // namespace holotrace
