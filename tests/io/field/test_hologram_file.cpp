#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <tuple>

#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/picture/panel_image_file.h"
#include "support/panels.h"
#include "support/png.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::make_file;
using test::temporary;

// A hologram with every level, row after row.
Hologram all_levels(int levels, Modulation modulation) {
  Hologram hologram;
  const int nx = levels <= 256 ? levels : 256, ny = (levels + nx - 1) / nx;
  hologram.grid = {nx, ny, 8e-6};
  hologram.level = Array2D<uint16_t>(ny, nx);
  for (size_t i = 0; i < hologram.level.size(); ++i) hologram.level.values[i] = uint16_t(i % size_t(levels));
  hologram.levels = levels;
  hologram.modulation = modulation;
  hologram.wavelength = 632.8e-9;
  hologram.image = ImageSide::real_image;
  hologram.encoder = "off-axis";
  hologram.filter = SpectralFilter{31250, 0, 15625, 62500};
  return hologram;
}

TEST(HologramFile, TheColoursOfAJointHologramComeBack) {
  const std::string path = temporary("h.png");
  Hologram hologram = all_levels(256, Modulation::phase);
  hologram.illumination = 3;
  hologram.colours = {{632.8e-9, 3}, {520e-9, 5.5}};
  save_hologram(path, hologram);
  const Hologram loaded = load_hologram(path);
  ASSERT_EQ(loaded.colours.size(), 2u);
  EXPECT_EQ(loaded.colours[1].wavelength, 520e-9);
  EXPECT_EQ(illumination_at(loaded, 520e-9), 5.5);
  EXPECT_EQ(illumination_at(loaded, 450e-9), 3);  // none of its own
  const std::string text = test::png_text(path, "holotrace");
  test::set_png_text(path, "holotrace", std::string(text).replace(text.find("5.5"), 3, "-1"));
  EXPECT_NE(error_of([&] { load_hologram(path); }).find("illuminations of 0 W/m² or more"), std::string::npos);
}

// Maps and moduli belong to a hologram as further frames do: the next call replaces them.
TEST(HologramFile, EncodingTwiceLeavesNoOldFiles) {
  const std::string folder = temporary("twice");
  std::filesystem::create_directories(folder);
  Hologram hologram = all_levels(256, Modulation::complex);
  hologram.modulus_level = hologram.level;
  hologram.slm = Slm{};
  hologram.slm->grid = hologram.grid;
  hologram.slm->effects.phase_map = std::make_shared<const Array2D<float>>(hologram.grid.ny, hologram.grid.nx);
  hologram.slm->effects.light_map = std::make_shared<const Array2D<float>>(hologram.grid.ny, hologram.grid.nx);
  for (int call = 0; call < 3; ++call) {
    const std::vector<std::string> notes =
        write_together(folder + "/h.png", hologram_record(folder + "/h.png"), [&](const OutputSet& set) {
          save_holograms(set, "h.png", {hologram, hologram});
        });
    EXPECT_TRUE(notes.empty()) << notes.front();
  }
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    EXPECT_FALSE(entry.path().string().ends_with("~")) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 8u);  // each of two: levels, moduli and two maps
}

TEST(HologramFile, EveryLevelComesBackAsSaved) {
  for (Modulation modulation : {Modulation::phase, Modulation::amplitude})
    for (int levels : {2, 3, 200, 255, 256, 257, 1000, 65536}) {
      const std::string path = temporary("h.png");
      const Hologram hologram = all_levels(levels, modulation);
      save_hologram(path, hologram);
      const Hologram loaded = load_hologram(path);
      EXPECT_EQ(loaded.level.values, hologram.level.values) << levels;
      EXPECT_EQ(loaded.grid, hologram.grid);
      EXPECT_EQ(loaded.levels, levels);
      EXPECT_EQ(loaded.modulation, modulation);
      EXPECT_EQ(loaded.wavelength, hologram.wavelength);
      EXPECT_EQ(loaded.image, hologram.image);
      EXPECT_EQ(loaded.encoder, hologram.encoder);
      EXPECT_EQ(loaded.filter, hologram.filter);
    }
}

TEST(HologramFile, EveryFormatBringsLevelsAndMetadataBack) {
  for (const std::string ending : {".bmp", ".tif", ".tiff", ".npy", ".csv"})
    for (const Modulation modulation : {Modulation::phase, Modulation::amplitude, Modulation::complex})
      for (const int levels : {2, 200, 256, 1024}) {
        if (ending == ".bmp" && levels > 256) continue;
        Hologram hologram = all_levels(levels, modulation);
        if (modulation == Modulation::complex) hologram.modulus_level = hologram.level;
        const std::string path = temporary("h" + ending);
        save_hologram(path, hologram, {2, 3});
        const Hologram loaded = load_hologram(path);
        EXPECT_EQ(loaded.level.values, hologram.level.values) << path << levels;
        EXPECT_EQ(loaded.modulus_level.values, hologram.modulus_level.values) << path << levels;
        EXPECT_EQ(loaded.grid, hologram.grid);
        EXPECT_EQ(loaded.levels, levels);
        EXPECT_EQ(loaded.wavelength, hologram.wavelength);
        EXPECT_TRUE(is_hologram_file(path));
        EXPECT_EQ(series_part(path).count, 3U);
      }
}

// As other programs write them: levels as numbers, or phases in radians, which become the nearest of 256 levels; a value
// beyond a cycle wraps.
TEST(HologramFile, TablesOfOtherProgramsAreHolograms) {
  const std::string csv = make_file("h.csv", "0,64\n128,255\n");
  EXPECT_FALSE(is_hologram_file(csv));
  EXPECT_EQ(load_hologram(csv).levels, 256);
  EXPECT_EQ(load_hologram(csv).level(1, 1), 255);
  const std::string fine = make_file("h.csv", "0,64\n128,1023\n");
  EXPECT_EQ(error_of([&] { load_hologram(fine); }),
            fine + ": expected the number of levels of this table, which reach 1023; give --levels");
  const Hologram santec = load_hologram(fine, [](HologramParams& params) { params.levels = 1024; });
  EXPECT_EQ(santec.level(1, 1), 1023);
  EXPECT_NE(error_of([&] {
              load_hologram(fine, [](HologramParams& params) { params.levels = 512; });
            }).find("expected the values of 512 levels, got 1023 at row 1, column 1; give their number (--levels)"),
            std::string::npos);
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 4), }";
  header.resize(117, ' ');
  const float phases[] = {0, 1.5707964F, -1.5707964F, 7.853982F};
  const std::string npy = make_file("h.npy", std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + "\n" +
                                                 std::string(reinterpret_cast<const char*>(phases), sizeof phases));
  const Hologram loaded = load_hologram(npy);
  EXPECT_EQ(std::vector<uint16_t>(loaded.level.values.begin(), loaded.level.values.end()),
            (std::vector<uint16_t>{0, 64, 192, 64}));
  EXPECT_EQ(load_hologram(npy, [](HologramParams& params) { params.levels = 4; }).level(0, 2), 3);
  const auto as_amplitude = [](HologramParams& params) { params.modulation = Modulation::amplitude; };
  EXPECT_NE(error_of([&] { load_hologram(npy, as_amplitude); }).find("expected amplitudes of 0 to 1, got 1.57"),
            std::string::npos);
  header.replace(header.find("(1, 4)"), 6, "(1, 2)");
  const float amplitudes[] = {0.5F, 1};
  const std::string modulus = make_file("a.npy", std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + "\n" +
                                                     std::string(reinterpret_cast<const char*>(amplitudes), 8));
  EXPECT_EQ(load_hologram(modulus, as_amplitude).level(0, 0), 128);  // 127.5
  EXPECT_EQ(load_hologram(modulus, as_amplitude).level(0, 1), 255);
}

// JSON of other programs beside a picture, and metadata of what was there before.
TEST(HologramFile, MetadataBesideAFileAreItsOwn) {
  const std::string path = temporary("h.bmp");
  save_panel_image(path, {2, 1, 1, 8, {3, 4}});
  write_text(old_sidecar_path(path), R"({"a": 1})");
  write_text(sidecar_path(path), R"({"kind": 1})");
  EXPECT_EQ(load_hologram(path).level(0, 1), 4);
  save_hologram(path, all_levels(16, Modulation::phase));
  EXPECT_EQ(load_hologram(path).levels, 16);
  save_panel_image(path, {16, 1, 1, 8, std::vector<uint16_t>(16, 16)});  // by another program
  EXPECT_EQ(error_of([&] { load_hologram(path); }), path + ": expected the levels of which " + sidecar_path(path) +
                                                        " has the metadata, got others; remove " + sidecar_path(path) +
                                                        " if another program has written " + path);
}

TEST(HologramFile, AColouredPictureHoldsThreeHolograms) {
  const std::string path = temporary("rgb.bmp");
  save_panel_image(path, {1, 2, 3, 8, {1, 2, 3, 40, 50, 60}});
  EXPECT_EQ(hologram_channels(path), (std::vector{Channel::red, Channel::green, Channel::blue}));
  const auto level = [&](Channel channel) {
    return load_hologram(path, [&](HologramParams& params) { params.channel = channel; }).level(1, 0);
  };
  EXPECT_EQ(level(Channel::red), 40);
  EXPECT_EQ(level(Channel::green), 50);
  EXPECT_EQ(level(Channel::blue), 60);
  const std::string grey = temporary("grey.bmp");
  save_panel_image(grey, {1, 1, 1, 8, {7}});
  EXPECT_EQ(hologram_channels(grey), std::vector{Channel::grey});
  EXPECT_EQ(error_of([&] { load_hologram(grey, [](HologramParams& params) { params.channel = Channel::blue; }); }),
            grey + ": expected a coloured picture for its channel blue, got a grey one; leave out the channel");
  // What was done for a panel cannot be undone.
  write_text(sidecar_path(grey), R"({"kind": "panel-image", "flip": "x"})");
  EXPECT_FALSE(is_hologram_file(grey));
  EXPECT_EQ(error_of([&] { load_hologram(grey); }),
            grey + ": expected a hologram, got a picture for a panel (" + sidecar_path(grey) +
                " says what was done to it); use the hologram that it was made of");
}

TEST(HologramFile, ASeriesBesideItsMetadataReplacesItsEarlierFiles) {
  const std::string folder = temporary("twice");
  std::filesystem::create_directories(folder);
  const std::vector<Hologram> holograms(3, all_levels(256, Modulation::phase));
  for (int call = 0; call < 2; ++call) {
    const std::vector<std::string> notes =
        write_together(folder + "/h.bmp", hologram_record(folder + "/h.bmp"),
                       [&](const OutputSet& set) { save_holograms(set, "h.bmp", holograms); });
    EXPECT_TRUE(notes.empty()) << notes.front();
  }
}

TEST(HologramFile, IlluminationNameAndFrameComeBackAsSaved) {
  const std::string path = temporary("h.png");
  Hologram hologram = all_levels(16, Modulation::phase);
  hologram.illumination = 0.1 + 0.2;
  hologram.label.name = "ES*L";
  hologram.label.frame = 12;
  hologram.label.cone_wavelength = 450.7e-9;
  hologram.losses.by_cone = false;
  save_hologram(path, hologram);
  const Hologram loaded = load_hologram(path);
  EXPECT_EQ(loaded.illumination, hologram.illumination);
  EXPECT_EQ(loaded.label.name, "ES*L");
  EXPECT_EQ(loaded.label.cone_wavelength, 450.7e-9);
  EXPECT_FALSE(loaded.losses.by_cone);
  EXPECT_TRUE(loaded.losses.by_pixels);
  EXPECT_EQ(loaded.label.frame, 12u);
  // Older files, and those without metadata, have the same brightness.
  test::drop_metadata(path);
  EXPECT_EQ(load_hologram(path).illumination, 1);
}

// Grey g shows 2πg/256: level 1 of 2 is half a turn, grey 128. Amplitude level 1 of 2 is the full amplitude, grey 255.
TEST(HologramFile, GreysAreRawAndMeanTheSameForAnyLevels) {
  const auto greys = [](Modulation modulation, int levels) {
    const std::string path = temporary("h.png");
    save_hologram(path, all_levels(levels, modulation));
    test::drop_metadata(path);
    return load_hologram(path);
  };
  EXPECT_EQ(greys(Modulation::phase, 2).level(0, 1), 128);
  EXPECT_EQ(greys(Modulation::phase, 3).level(0, 2), 171);  // round(2·256/3)
  EXPECT_EQ(greys(Modulation::amplitude, 2).level(0, 1), 255);
  EXPECT_EQ(greys(Modulation::phase, 1024).level(0, 1), 64);  // of 65536
}

TEST(HologramFile, KnowsHowItsRunLooked) {
  const std::string path = temporary("h.png");
  Hologram hologram = all_levels(256, Modulation::phase);
  hologram.viewing = {{0.2970123456789, 0.303}, 3e-3, {1e-3, -2e-3, 0.25}};
  save_hologram(path, hologram);
  for (const ViewingConditions& viewing : {load_hologram(path).viewing, viewing_of_file(path)}) {
    EXPECT_EQ(viewing.distances, hologram.viewing.distances);  // to the last bit
    EXPECT_EQ(viewing.pupil, 3e-3);
    EXPECT_EQ(viewing.eye, hologram.viewing.eye);
  }
  const std::string text = test::png_text(path, "holotrace");
  for (const auto& [from, to, words] :
       {std::tuple{"-0.002,0.25", "-0.002,-0.25", "a pupil and an eye's z of 0 m or more"},
        std::tuple{"[0.001,-0.002,0.25]", "[0.001,0.25]", "expected three numbers for \"eye_m\", got ["},
        std::tuple{"\"pupil_m\":0.003", "\"pupil_m\":\"3 mm\"", "expected a number for \"pupil_m\""},
        std::tuple{"0.303]", "null]", "expected a number for \"distances_m[1]\", got null"}}) {
    ASSERT_NE(text.find(from), std::string::npos) << text;
    test::set_png_text(path, "holotrace", replace_all(text, from, to));
    for (const std::string& error : {error_of([&] { load_hologram(path); }), error_of([&] { viewing_of_file(path); })})
      EXPECT_NE(error.find(words), std::string::npos) << error;
  }
  // Without a pupil the light of the whole panel is seen, wherever the eye is.
  CameraParams camera;
  camera.eye = {0, 0, 0.25};
  camera.distances = {0.1};
  hologram.viewing = viewing_conditions(camera);
  save_hologram(path, hologram);
  EXPECT_EQ(viewing_of_file(path).eye, Vec3());
  EXPECT_EQ(camera_in(viewing_of_file(path)).distances, camera.distances);
}

// Files of earlier versions, those of other programs, and metadata beside the file.
TEST(HologramFile, MayNotKnowHowItsRunLooked) {
  const std::string path = temporary("h.png");
  Hologram hologram = all_levels(256, Modulation::phase);
  save_hologram(path, hologram);
  EXPECT_EQ(test::png_text(path, "holotrace").find("viewing"), std::string::npos);
  EXPECT_FALSE(load_hologram(path).viewing.are_known() || viewing_of_file(path).are_known());
  EXPECT_EQ(camera_in(viewing_of_file(path)).distances, CameraParams().distances);
  test::drop_metadata(path);
  EXPECT_FALSE(viewing_of_file(path).are_known());
  write_text(sidecar_path(path), R"({"pitch_m": 3e-6, "wavelength_m": 450e-9, "viewing": {"distances_m": [0.1]}})");
  EXPECT_EQ(viewing_of_file(path).distances, std::vector<double>{0.1});
}

TEST(HologramFile, WithoutMetadataTheCallerSaysTheRest) {
  const std::string path = temporary("h.png");
  save_hologram(path, all_levels(256, Modulation::amplitude));
  test::drop_metadata(path);
  const Hologram loaded = load_hologram(path);
  EXPECT_EQ(loaded.levels, 256);
  EXPECT_EQ(loaded.modulation, Modulation::phase);
  EXPECT_EQ(loaded.grid, (Grid{256, 1, 0}));
  EXPECT_EQ(loaded.wavelength, 0);
  save_hologram(path, all_levels(1024, Modulation::phase));
  test::drop_metadata(path);
  EXPECT_EQ(load_hologram(path).levels, 65536);
}

// PNG readers refuse texts of more than 8 MB.
TEST(HologramFile, MetadataTooLongForAPngIsBesideIt) {
  const std::string path = temporary("h.png");
  Hologram hologram = all_levels(16, Modulation::phase);
  hologram.slm = make_panel(16, 1);
  hologram.slm->levels = 16;
  hologram.slm->effects.dead_pixels.assign(700'000, {15, 0, 11});  // [15,0,11] and a comma: 10 bytes each
  save_hologram(path, hologram);
  EXPECT_EQ(test::png_text(path, "holotrace"), "");
  EXPECT_TRUE(is_hologram_file(path));
  EXPECT_EQ(load_hologram(path).slm->effects.dead_pixels.size(), 700'000U);
}

// Earlier versions wrote NAME.json; what is inside the file counts first.
TEST(HologramFile, SidecarsOfEarlierVersionsAreRead) {
  const std::string path = temporary("h.png");
  save_hologram(path, all_levels(256, Modulation::phase));
  EXPECT_FALSE(std::filesystem::exists(sidecar_path(path)) || std::filesystem::exists(old_sidecar_path(path)));
  write_text(old_sidecar_path(path), R"({"pitch_m": 3e-6, "wavelength_m": 450e-9, "modulation": "phase"})");
  EXPECT_EQ(load_hologram(path).grid.pitch, 8e-6);
  test::drop_metadata(path);
  EXPECT_TRUE(is_hologram_file(path));
  EXPECT_EQ(load_hologram(path).grid.pitch, 3e-6);
  std::filesystem::remove(old_sidecar_path(path));
  EXPECT_FALSE(is_hologram_file(path));
}

// Names in any script: PNG asks for Latin-1 in its texts, JSON escapes the rest.
TEST(HologramFile, MetadataIsAsciiInsideThePng) {
  const std::string path = temporary("h.png");
  Hologram hologram = all_levels(4, Modulation::phase);
  hologram.label.name = "Würfel 箱";
  save_hologram(path, hologram, {2, 3}, [] { return FileRecord{{"h_modulus.png", 7}}; });
  const std::string text = test::png_text(path, "holotrace");
  EXPECT_TRUE(std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; })) << text;
  EXPECT_EQ(load_hologram(path).label.name, hologram.label.name);
  EXPECT_EQ(series_part(path).number, 2U);
  EXPECT_EQ(series_part(path).count, 3U);
  EXPECT_EQ(hologram_record(path), (FileRecord{{"h_modulus.png", 7}}));
}

TEST(HologramFile, GreysThatAreNoLevelAreRefused) {
  const std::string path = temporary("h.png");
  save_hologram(path, all_levels(256, Modulation::phase));
  test::set_png_text(path, "holotrace", R"({"pitch_m": 8e-6, "wavelength_m": 532e-9, "levels": 2})");
  EXPECT_EQ(error_of([&] { load_hologram(path); }),
            path + ": expected the greys of 2 levels, got 1 at row 0, column 1; correct \"levels\" in " + path +
                " or write the hologram again, without scaling or compression loss");
}

TEST(HologramFile, ACalibrationHasAsManyAmplitudesAsPhases) {
  const std::string path = temporary("h.png");
  save_hologram(path, all_levels(256, Modulation::phase));
  test::set_png_text(path, "holotrace",
                     R"({"pitch_m": 8e-6, "wavelength_m": 532e-9, "slm": {"design_wavelength_m": 0, "fill_factor": 1, )"
                     R"("levels": 2, "effects": {"calibration": {"phase_rad": [0, 3.1], "amplitude": [1]}}}})");
  EXPECT_EQ(error_of([&] { load_hologram(path); }),
            path + ": expected as many calibrated amplitudes as phases, got 1 and 2; write the hologram again");
}

TEST(HologramFile, LevelsThatNoPanelHasAreRefused) {
  const std::string path = temporary("h.png");
  save_hologram(path, all_levels(256, Modulation::phase));
  const std::string range = ": expected 2 to 65536 levels, got ", whole = ": expected a whole number from ";
  for (const auto& [wrong, words] :
       {std::pair{"2.33333e37", whole}, {"-5", range}, {"2.5", whole}, {"1", range}, {"65537", range}}) {
    test::set_png_text(
        path, "holotrace",
        R"({"pitch_m": 8e-6, "wavelength_m": 532e-9, "slm": {"design_wavelength_m": 0, "fill_factor": 1, )"
        R"("levels": )" +
            std::string(wrong) + "}}");
    EXPECT_EQ(error_of([&] { load_hologram(path); }).find(path + words), 0) << wrong;
  }
}

TEST(HologramFile, WhatIsNoHologramIsRefused) {
  const std::string text = make_file("h.png", "only text");
  EXPECT_EQ(error_of([&] { load_hologram(text); }),
            text + ": expected a hologram as a grey image, but it is not an image; write it as an 8- or 16-bit PNG");
  const std::string coloured = temporary("c.png");
  Image image(1, 2, 3);
  image.values = {0, 0, 0, 1, 0, 0};
  save_image(coloured, image, 1, 8);
  EXPECT_EQ(
      error_of([&] { load_hologram(coloured); }),
      coloured +
          ": expected a grey hologram, got a coloured pixel at row 0, column 1; name the channel (--channel red, green or blue), or make a "
          "hologram of a picture with holotrace encode");
  EXPECT_EQ(
      error_of([] { save_hologram("h.jpg", all_levels(2, Modulation::phase)); }),
      "expected a hologram file .png, .bmp, .tif, .npy or .csv, got h.jpg, and a JPEG would change the levels of its pixels; change its "
      "extension");
  Hologram wrong = all_levels(2, Modulation::phase);
  wrong.level(0, 0) = 2;
  EXPECT_EQ(error_of([&] { save_hologram("h.png", wrong); }),
            "expected levels below 2 in the hologram to save as h.png, got 2");
}

}  // namespace
}  // namespace holotrace
