#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/ply.h"
#include "holotrace/io/mesh/point_file.h"
#include "support/data_files.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::make_file;
using test::temporary;

const Sources some_sources{632.8e-9, {{{1e-3, -2e-3, -0.3}, 0.5f, 1.25f}, {{0.1, 0.2, -0.7}, 2.0f, -3.0f}}};

std::string ascii(const std::string& rows, const std::string& comment = "comment wavelength_m 5.32e-07\n",
                  int count = 1) {
  return "ply\nformat ascii 1.0\n" + comment + "element vertex " + std::to_string(count) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty float amplitude\nproperty float phase\n"
         "end_header\n" +
         rows;
}

TEST(SourcesFile, SourcesComeBackAsSaved) {
  const std::string path = temporary("s.ply");
  save_sources(path, some_sources);
  const Sources loaded = load_sources(path);
  EXPECT_EQ(loaded.wavelength, some_sources.wavelength);  // %.17g keeps every double
  EXPECT_EQ(loaded.waves, some_sources.waves);
}

TEST(SourcesFile, KeysTilesNameAndFrameComeBackAsSaved) {
  const std::string path = temporary("s.ply");
  Sources sources = some_sources;
  sources.label.name = "lamp of the desk";
  sources.phase_keys = {0x123456789abcdef0, Sources::no_phase_key};  // 64 bits, more than a double can hold
  sources.seed = ~uint64_t(0) - 5;
  sources.label.frame = 3000000000u;
  sources.label.cone_wavelength = 450.7e-9;
  sources.tiles = {3, 2, {}};
  for (int i = 0; i < 12; ++i) sources.tiles.values.push_back(std::sqrt(float(i)));
  save_sources(path, sources);
  const Sources loaded = load_sources(path);
  EXPECT_EQ(loaded.waves, sources.waves);
  EXPECT_EQ(loaded.label.name, sources.label.name);
  EXPECT_EQ(loaded.phase_keys, sources.phase_keys);
  EXPECT_EQ(loaded.seed, sources.seed);
  EXPECT_EQ(loaded.label.frame, sources.label.frame);
  EXPECT_EQ(loaded.label.cone_wavelength, sources.label.cone_wavelength);
  EXPECT_EQ(loaded.tiles, sources.tiles);
  const std::string bytes = read_text(path);
  save_sources(path, loaded);
  EXPECT_EQ(read_text(path), bytes);
}

TEST(SourcesFile, SecondFociComeBackAsSaved) {
  const std::string path = temporary("s.ply");
  Sources sources = some_sources;
  sources.tiles = {1, 1, {3, 4}};
  sources.second_foci = {{{1e-3, -2e-3, -0.41234567890123}, {0.6, 0.8, 0}}, {}};
  save_sources(path, sources);
  const Sources loaded = load_sources(path);
  EXPECT_EQ(loaded.second_foci, sources.second_foci);
  EXPECT_EQ(loaded.waves, sources.waves);
  EXPECT_EQ(loaded.tiles, sources.tiles);
  sources.second_foci.front().line = {0, 1, 1};
  EXPECT_EQ(
      error_of([&] { save_sources(path, sources); }),
      "expected the focal line of source 0 as a unit vector at right angles to the way from its origin to its second focus, "
      "got (0, 1, 1)");
  sources.second_foci.front().line = {0, 0, 1};  // of length 1, but along the way
  EXPECT_EQ(error_of([&] { save_sources(path, sources); }).rfind("expected the focal line of source 0 as a unit", 0),
            0U);
}

TEST(SourcesFile, WrongKeysAndTilesAreRefused) {
  const std::string path = temporary("s.ply");
  Sources sources = some_sources;
  sources.phase_keys = {1};
  EXPECT_EQ(error_of([&] { save_sources(path, sources); }), "expected a phase key for each of 2 waves, or none, got 1");
  sources = some_sources;
  sources.tiles = {2, 2, {1, 2, 3}};
  EXPECT_EQ(error_of([&] { save_sources(path, sources); }), "expected 8 amplitudes for 2 × 2 tiles and 2 waves, got 3");
  const auto error = [](const std::string& comment) {
    const std::string file = make_file("t.ply", ascii("0 0 -1 1 0\n", "comment wavelength_m 5.32e-07\n" + comment));
    return error_of([&] { load_sources(file); }).substr(file.size());
  };
  EXPECT_EQ(error("comment frame one\n"), ": expected a whole number in \"comment frame\", got \"one\"");
  EXPECT_EQ(error("comment tiles 2\n"), ": expected columns and rows in \"comment tiles\", got \"2\"");
  EXPECT_EQ(error("comment tiles 0 2\n"), ": expected 1 to 4096 columns and rows of tiles, got 0 × 2");
  EXPECT_EQ(error("comment tiles 2 2\n"),
            ": expected the property \"amplitude_0\" of the element \"vertex\", which "
            "is missing");
}

TEST(SourcesFile, TheHeaderIsTheOneThatOtherProgramsRead) {
  const std::string path = temporary("s.ply");
  save_sources(path, some_sources);
  const std::string bytes = read_text(path);
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment wavelength_m 6.328e-07\nelement vertex 2\nproperty double x\n"
      "property double y\nproperty double z\nproperty float amplitude\nproperty float phase\nend_header\n";
  // 632.8e-9 in 17 digits is 6.3279999999999997e-07, the same double.
  EXPECT_EQ(bytes.substr(0, 56), header.substr(0, 56));
  EXPECT_EQ(bytes.substr(bytes.find("element")),
            header.substr(header.find("element")) + bytes.substr(bytes.size() - 64));
}

TEST(SourcesFile, AsciiFilesAreReadWithTheirWavelength) {
  const Sources sources = load_sources(make_file("s.ply", ascii("1e-3 -2e-3 -0.3 0.5 1.25\n")));
  EXPECT_EQ(sources.wavelength, 532e-9);
  ASSERT_EQ(sources.waves.size(), 1u);
  EXPECT_EQ(sources.waves[0], (Source{{1e-3, -2e-3, -0.3}, 0.5f, 1.25f}));
}

TEST(SourcesFile, AFileWithoutAWavelengthTakesTheDefault) {
  const std::string path = make_file("s.ply", ascii("0 0 -1 1 0\n", ""));
  EXPECT_EQ(load_sources(path, 638e-9).wavelength, 638e-9);
  EXPECT_EQ(error_of([&] { load_sources(path); }), path +
                                                       ": expected a line \"comment wavelength_m …\", got none; pass "
                                                       "the wavelength, such as --wavelength \"532 nm\"");
}

TEST(SourcesFile, SourcesOnThePanelAreNamed) {
  const std::string path = make_file("s.ply", ascii("0 0 0.3 1 0\n0 0 0 1 0\n", "comment wavelength_m 5e-7\n", 2));
  EXPECT_EQ(error_of([&] { load_sources(path); }),
            path + ": expected source 1 behind the panel (z < 0) or in front of it (z > 0), got z = 0 m");
}

TEST(SourcesFile, NumbersThatAreNotFiniteAreNamed) {
  const std::string path = make_file("s.ply", ascii("0 0 -1 nan 0\n"));
  EXPECT_EQ(error_of([&] { load_sources(path); }),
            path + ": expected finite numbers in source 0, got origin (0, 0, -1) m, amplitude nan, phase 0");
  EXPECT_EQ(error_of([&] {
              save_sources(temporary("t.ply"), {532e-9, {{{0, 0, -INFINITY}, 1, 0}}});
            }),
            "expected finite numbers in source 0, got origin (0, 0, -inf) m, amplitude 1, phase 0");
}

TEST(SourcesFile, MissingPropertiesAreNamed) {
  const std::string path = make_file(
      "s.ply",
      "ply\nformat ascii 1.0\ncomment wavelength_m 5e-7\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n0 0 -1\n");
  EXPECT_EQ(error_of([&] { load_sources(path); }),
            path + ": expected the property \"amplitude\" of the element \"vertex\", which is missing");
}

TEST(SourcesFile, OtherExtensionsAreRefused) {
  EXPECT_EQ(error_of([&] { save_sources("s.txt", some_sources); }),
            "expected a file of sources .ply, got s.txt; change its extension");
}

// Elements before, lists in between, every type, the three encodings: 1.5 as a float is 3FC00000.
TEST(Ply, EveryEncodingAndTypeGivesTheSameColumns) {
  const std::string head =
      "element early 1\nproperty list uchar short numbers\nelement vertex 1\nproperty char a\n"
      "property list uchar int face\nproperty float32 b\nproperty ushort c\nelement late 1\n"
      "property double d\nend_header\n";
  const std::string ascii_file =
      "ply\r\nformat ascii 1.0\r\nobj_info made by hand\r\n" + head + "2 7 8 -3 1 9 1.5 513 0.5\n";
  const std::string little("\x02\x07\x00\x08\x00\xfd\x01\x09\x00\x00\x00\x00\x00\xc0\x3f\x01\x02", 17);
  const std::string big("\x02\x00\x07\x00\x08\xfd\x01\x00\x00\x00\x09\x3f\xc0\x00\x00\x02\x01", 17);
  for (const std::string& bytes : {ascii_file, "ply\nformat binary_little_endian 1.0\n" + head + little,
                                   "ply\nformat binary_big_endian 1.0\n" + head + big}) {
    const PlyVertices vertices = read_ply(make_file("v.ply", bytes));
    ASSERT_EQ(vertices.count, 1u);
    EXPECT_EQ(vertices.names, (std::vector<std::string>{"a", "b", "c"}));
    EXPECT_EQ(vertices.column("a")[0], -3);
    EXPECT_EQ(vertices.column("b")[0], 1.5);
    EXPECT_EQ(vertices.column("c")[0], 513);  // 0x0201
  }
}

TEST(Ply, DamagedFilesAreNamedWithTheirLine) {
  const auto error = [](const std::string& bytes) {
    const std::string path = make_file("v.ply", bytes);
    return error_of([&] { read_ply(path); }).substr(path.size());
  };
  const std::string vertex = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nend_header\n";
  EXPECT_EQ(error(""), ":1: expected a PLY file, got other bytes; its first line must be \"ply\"");
  EXPECT_EQ(error("solid\n"), ":1: expected a PLY file, got other bytes; its first line must be \"ply\"");
  EXPECT_EQ(error("ply\nformat ascii 1.0\n"),
            ": expected \"end_header\" in the PLY header, but the file ends before it; write it again");
  EXPECT_EQ(error("ply\nformat text 1.0\nend_header\n"),
            ":2: expected the format ascii, binary_little_endian or binary_big_endian, got \"text\"");
  EXPECT_EQ(error("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n"),
            ":4: expected a PLY type such as float or uchar, got \"real\"");
  EXPECT_EQ(error(vertex + "1 one\n"), ":6: expected a number, got \"one\"");
  EXPECT_EQ(error(vertex + "1   \n"),
            ": expected more numbers than the file holds; it is truncated or its header is wrong");
  EXPECT_EQ(
      error("ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nend_header\nabcd"),
      ": expected 4000000000 of the element \"vertex\", but the file is truncated or its header is wrong");
  EXPECT_EQ(error("ply\nformat ascii 1.0\nelement face 0\nproperty int x\nend_header\n"),
            ": expected an element \"vertex\" in the PLY file, got none");
}

TEST(PointFile, SourcesAreReadAsPoints) {
  const std::string path = temporary("s.ply");
  save_sources(path, some_sources);
  const auto points = load_points(path);
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].position, some_sources.waves[0].origin);
  EXPECT_EQ(points[0].amplitude, 0.5f);
  EXPECT_EQ(points[0].phase, 1.25f);
}

TEST(PointFile, ColoursBecomeAmplitudes) {
  const std::string path =
      make_file("p.ply",
                "ply\nformat ascii 1.0\nelement color 1\nproperty int channel\nelement vertex 1\nproperty float x\n"
                "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                "property double phase\nend_header\n3\n1 2 3 255 51 0 0.5\n");
  EXPECT_EQ(load_points(path, PointChannel::red)[0].amplitude, 1);
  EXPECT_EQ(load_points(path, PointChannel::green)[0].amplitude, 0.2f);
  EXPECT_EQ(load_points(path, PointChannel::blue)[0].amplitude, 0);
  EXPECT_FLOAT_EQ(load_points(path)[0].amplitude, float(0.2126 + 0.7152 * 0.2));  // ITU-R BT.709
  EXPECT_EQ(load_points(path)[0].phase, 0.5f);
}

// Point k of the helix of 500 points: height t = k/499, four turns, red 255·t, green 255·(1 − t), blue k mod 256.
TEST(PointFile, PointsOfOpenHolosDialectAreRead) {
  const auto points = load_points(test::data_file("helix_points.ply"));
  ASSERT_EQ(points.size(), 500u);
  for (const size_t k : {0u, 100u, 499u}) {
    const double t = double(k) / 499, a = 8 * pi * t;
    EXPECT_LT(length(points[k].position - Vec3{std::cos(a) / 2, t - 0.5, std::sin(a) / 2}), 2e-6) << k;  // six digits
    EXPECT_NEAR(points[k].phase, 2 * pi * t, 1e-6) << k;
    const double luminance =
        0.2126 * std::round(255 * t) + 0.7152 * std::round(255 * (1 - t)) + 0.0722 * double(k % 256);
    EXPECT_FLOAT_EQ(points[k].amplitude, float(luminance / 255)) << k;
  }
}

}  // namespace
}  // namespace holotrace
