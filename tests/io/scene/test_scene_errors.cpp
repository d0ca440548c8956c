#include <gtest/gtest.h>

#include "holotrace/io/scene/scene_file.h"
#include "io/scene/scene_text.h"
#include "support/data_files.h"
#include "support/temporary.h"

// What scene files may not say: each error names its line and column.

namespace holotrace {
namespace {

using test::cube;
using test::error_with;
using test::make_file;
using test::scene_error;

TEST(SceneFileErrors, AMissingFileIsNamed) {
  const std::string path = test::temporary("none.toml");
  EXPECT_EQ(error_of([&] { load_job(path); }),
            "expected a scene file at " + path + ", but there is no such file; check the path");
}

TEST(SceneFileErrors, BrokenTomlIsPlaced) {
  EXPECT_EQ(scene_error("wavelength = \"532 nm\"\n[slm\n"),
            "2:5: expected a table such as [camera] or [[object]]; the line is \"[slm\"");
}

// The library's own words ("saw EOF", "value-terminator") are not among them.
TEST(SceneFileErrors, EveryDamageToTomlIsAnErrorInOurWords) {
  const std::string table = "expected a table such as [camera] or [[object]]", key = "expected KEY = VALUE",
                    text = "expected a text that ends with the quote",
                    number = "expected a number that fits, or a text";
  const std::vector<std::pair<const char*, std::string>> cases = {
      {"[+a]\n", table},
      {"[=]\n", table},
      {"[[", table},
      {"[a.]\n", table},
      {"a={=1}", "expected a table such as { a = 1, b = 2 }"},
      {"a.=1\n", key},
      {"a b\n", key},
      {"\xff", "expected text in UTF-8"},
      {"a=\"\n", text},
      {"a=\"\\q\"\n", "expected an escape sequence such as \\n"},
      {"a = [1,\n", "expected a list such as [1, 2, 3]"},
      {"a = tru\n", "expected true or false"},
      {"a = 1e400\n", number},
      {"a = 99999999999999999999\n", number},
      {"a = 12x\n", number},
      {"a = 1979-99-99\n", number},
      {"a =\n", "expected a value: a number, a text in quotes"},
      {"a = 1\na = 2\n", "expected each key and each table once"},
      {"# \x01\n", "expected text, got a control character"},
  };
  for (const auto& [scene, expected] : cases) {
    const std::string error = scene_error(scene);
    EXPECT_NE(error.find(expected), std::string::npos) << scene << error;
    EXPECT_NE(error.find("; the line is \""), std::string::npos) << scene << error;
  }
}

TEST(SceneFileErrors, UnknownKeysAreRefusedEverywhere) {
  EXPECT_EQ(scene_error("wavelenght = \"532 nm\"\n"), "1:1: unknown key \"wavelenght\"; did you mean \"wavelength\"?");
  EXPECT_EQ(error_with("[slm]\nptich = \"8 um\"\n"), "3:1: unknown key \"ptich\"; did you mean \"pitch\"?");
  EXPECT_EQ(error_with("[camera]\nbits = 8\ndistance = \"1 m\"\n" + cube),
            "4:1: unknown key \"distance\"; did you mean \"distances\"?");
  EXPECT_EQ(error_with("[[object]]\ntype = \"box\"\nsize = \"1 1 1 mm\"\ncolor = 1\n"),
            "5:1: unknown key \"color\"; known: distance, fit, material, name, position, positions, rotation, scale, "
            "size, type");
  EXPECT_EQ(error_with("[[object]]\ntype = \"wireframe_cube\"\nsize = \"1 mm\"\nmaterial = \"x\"\n").substr(0, 24),
            "5:1: unknown key \"materi");
  EXPECT_EQ(error_with("[[light]]\ntype = \"point\"\nposition = \"0 0 0 m\"\nintensty = 1\n"),
            "5:1: unknown key \"intensty\"; did you mean \"intensity\"?");
  EXPECT_EQ(error_with("[materials.a]\nreflectence = 1\n"),
            "3:1: unknown key \"reflectence\"; did you mean \"reflectance\"?");
  EXPECT_EQ(error_with("[[shape.a]]\ntype = \"sphere\"\nsize = \"1 mm\"\nsegmnts = 8\n" + cube),
            "5:1: unknown key \"segmnts\"; did you mean \"segments\"?");
  EXPECT_EQ(
      error_with("[scene]\n"),
      "2:2: unknown key \"scene\"; known: analyser, animate, background, camera, encode, environment, eye, light, materials, media, object, "
      "polarization, propagate, reflectances, render, shape, show, shutter, slm, synthesize, time, trace, wavelength");
}

TEST(SceneFileErrors, UnknownNamesAreRefused) {
  EXPECT_EQ(error_with("[slm]\npreset = \"plto\"\n"),
            "3:10: unknown SLM \"plto\"; did you mean \"pluto\"? \"holotrace info --slm\" lists all");
  EXPECT_EQ(error_with("[[object]]\ntype = \"shpere\"\n"),
            "3:8: unknown object type \"shpere\"; did you mean \"sphere\"?");
  EXPECT_EQ(error_with("[[light]]\ntype = \"sun\"\n"),
            "3:8: unknown light type \"sun\"; did you mean \"directional\"?");
  EXPECT_EQ(error_with("[[light]]\ntype = \"candle\"\n"),
            "3:8: unknown light type \"candle\"; known: point, spot, directional, rectangle, laser-point, laser-beam");
  EXPECT_EQ(error_with("[trace]\npattern = \"gird\"\n" + cube),
            "3:11: unknown pattern \"gird\"; did you mean \"grid\"?");
  EXPECT_EQ(error_with("[materials.ivory]\n[[object]]\ntype = \"sphere\"\nsize = \"1 mm\"\nmaterial = \"ivori\"\n"),
            "6:12: unknown material \"ivori\"; did you mean \"ivory\"?");
  EXPECT_EQ(error_with("[[object]]\ntype = \"shape\"\nshape = \"king\"\n"),
            "4:9: unknown shape \"king\"; none is defined");
  EXPECT_EQ(error_with("[[object]]\ntype = \"sphere\"\nsize = \"1 mm\"\nmaterial = \"red\"\n"),
            "5:12: unknown material \"red\"; none is defined; add a table [materials.red] with its type");
  EXPECT_EQ(error_with("[materials.a]\ntype = \"glass\"\n"),
            "3:8: unknown material type \"glass\"; did you mean \"dielectric\"?");
}

TEST(SceneFileErrors, AKeyBelowTheWrongHeadingIsSentToItsOwn) {
  EXPECT_EQ(error_with("[camera]\npaths = 3\n" + cube),
            "3:1: unknown key \"paths\" in [camera]; it belongs below [trace] or below [render]");
  EXPECT_EQ(error_with("[slm]\nquality = \"good\"\n" + cube),
            "3:1: unknown key \"quality\" in [slm]; it belongs below [encode]");
  EXPECT_EQ(error_with("[camera]\nwavelength = \"532 nm\"\n" + cube),
            "3:1: unknown key \"wavelength\" in [camera]; it belongs above all headings or below [show]");
  EXPECT_EQ(error_with("[camera]\npuipl = \"3 mm\"\n" + cube), "3:1: unknown key \"puipl\"; did you mean \"pupil\"?");
}

TEST(SceneFileErrors, APanelsNameIsNoTable) {
  EXPECT_EQ(error_with("slm = \"pluto\"\n"),
            "2:7: expected a table headed [slm], with preset = \"pluto\" below it, for \"slm\", got \"pluto\"");
}

TEST(SceneFileErrors, ABareNumberIsNoLength) {
  EXPECT_EQ(scene_error("wavelength = 632.8\n"),
            "1:14: expected a length with its unit, such as \"532 nm\", for \"wavelength\", got the bare number 632.8");
  EXPECT_EQ(
      scene_error("wavelength = \"632.8\"\n"),
      "1:14: expected a length with its unit, such as \"532 nm\", got \"632.8\" without a unit for \"wavelength\"");
  EXPECT_EQ(error_with("[slm]\npitch = 8\n"),
            "3:9: expected a length with its unit, such as \"8 um\", for \"pitch\", got the bare number 8");
  EXPECT_EQ(error_with("[camera]\ndistances = [0.3]\n" + cube),
            "3:14: expected a length with its unit, such as \"300 mm\", for \"distances\", got the bare number 0.3");
  EXPECT_EQ(
      error_with("[encode]\nreference_angle_x = 1\n" + cube),
      "3:21: expected an angle with its unit, such as \"15 deg\", for \"reference_angle_x\", got the bare number 1");
  EXPECT_EQ(error_with("[[object]]\ntype = \"sphere\"\nsize = \"1 mm\"\nposition = \"0 -300 mm\"\n"),
            "5:12: expected three lengths for \"position\", such as \"0 0 -300 mm\", got 2");
  EXPECT_EQ(error_with("[[object]]\ntype = \"box\"\nsize = \"3 mm\"\nposition = \"0 0 -300 mm\"\n"),
            "4:8: expected three lengths for \"size\", such as \"3 3 3 mm\", got 1");
}

TEST(SceneFileErrors, NumbersThatAreNotFiniteAreRefused) {
  EXPECT_EQ(scene_error("wavelength = \"nan nm\"\n"),
            "1:14: expected a length that is finite, got \"nan nm\" for \"wavelength\"");
  EXPECT_EQ(error_with("[synthesize]\ntolerance = inf\n" + cube),
            "3:13: expected a number above 0 and below 1 for \"tolerance\", got inf");
  EXPECT_EQ(error_with("background = [0, nan, 0]\n"),
            "2:18: expected finite numbers of 0 or more for \"background\", got nan");
  EXPECT_EQ(error_with("[materials.a]\nreflectance = 1.5\n"),
            "3:15: expected finite numbers from 0 to 1 for \"reflectance\", got 1.5");
}

TEST(SceneFileErrors, ImpossiblePanelsAndLightAreRefused) {
  EXPECT_EQ(scene_error("wavelength = \"0 nm\"\n"), "1:14: expected a length above 0 m for \"wavelength\", got 0 m");
  EXPECT_EQ(scene_error("wavelength = \"-5 nm\"\n"), "1:14: expected a length above 0 m for \"wavelength\", got -5 nm");
  EXPECT_EQ(error_with("[slm]\npitch = \"-8 um\"\n"), "3:9: expected a length above 0 m for \"pitch\", got -8 µm");
  EXPECT_EQ(error_with("[slm]\npitch = \"0 um\"\n"), "3:9: expected a length above 0 m for \"pitch\", got 0 m");
  EXPECT_EQ(error_with("[slm]\ncolumns = 0\n"), "3:11: expected a whole number of 1 or more for \"columns\", got 0");
  EXPECT_EQ(error_with("[slm]\nrows = -1\n"), "3:8: expected a whole number of 1 or more for \"rows\", got -1");
  EXPECT_EQ(error_with("[slm]\nrows = 3000000000\n"), "3:8: expected at most 2147483647 for \"rows\", got 3000000000");
  EXPECT_EQ(error_with("[slm]\nlevels = 1\n"), "3:10: expected a whole number from 2 to 65536 for \"levels\", got 1");
  EXPECT_EQ(error_with("[slm]\nrows = 10.5\n"), "3:8: expected a whole number for \"rows\", got the bare number 10.5");
}

TEST(SceneFileErrors, ImpossibleParametersAreRefused) {
  EXPECT_EQ(error_with("[trace]\ncolumns = -1\n" + cube),
            "3:11: expected a whole number of 0 or more for \"columns\", got -1");
  EXPECT_EQ(error_with("[camera]\nbits = 12\n" + cube), "3:8: expected 8 or 16 for \"bits\", got 12");
  EXPECT_EQ(error_with("[synthesize]\ntolerance = 0\n" + cube),
            "3:13: expected a number above 0 and below 1 for \"tolerance\", got 0");
}

TEST(SceneFileErrors, ObjectsInThePlaneOfThePanelAreNamed) {
  const std::string quad = "[[object]]\ntype = \"quad\"\nwidth = \"1 mm\"\nheight = \"1 mm\"\n";
  EXPECT_EQ(error_with(quad),
            "2:1: expected the object behind the panel (z < 0) or in front of it (z > 0), got one in the plane of the "
            "panel, z = 0; set its \"position\", such as \"0 0 -300 mm\"");
  EXPECT_EQ(error_with(quad + "position = \"0 0 5 mm\"\n"), "no error");
}

TEST(SceneFileErrors, AnEmptySceneIsRefused) {
  EXPECT_EQ(error_with(""),
            "1:1: expected at least one object in the scene, a visible rectangle light, or a background, got none");
  EXPECT_EQ(scene_error(""),
            "1:1: expected at least one object in the scene, a visible rectangle light, or a background, got none");
}

TEST(SceneFileErrors, WhatShapesAndFilesRefuseIsPlaced) {
  EXPECT_EQ(error_with("[[object]]\ntype = \"sphere\"\n"),
            "2:1: expected the key \"size\" in [[object]], which is missing");
  EXPECT_EQ(error_with("[[object]]\ntype = \"sphere\"\nsize = \"1 mm\"\nsegments = 2\n"),
            "5:12: expected a whole number from 3 to 4096 for \"segments\", got 2");
  EXPECT_EQ(error_with("[[object]]\ntype = \"lathe\"\nprofile = { unit = \"furlong\", points = [[0, 1], [1, 2]] }\n"),
            "4:20: expected a length in one of the units nm, um, µm, mm, cm, m, got \"0 furlong\"");
  EXPECT_EQ(
      error_with(
          "[[object]]\ntype = \"extrusion\"\ndepth = \"1 mm\"\noutline = { unit = \"mm\", points = [[0, 1, 2]] }\n"),
      "5:36: expected a list of pairs [[1, 2], …] for \"points\", got a list");
  const std::string missing = error_with("[[object]]\ntype = \"mesh\"\nfile = \"none.obj\"\n");
  EXPECT_TRUE(missing.starts_with("4:8: expected a mesh at ")) << missing;
  const std::string text = make_file("text.png", "only text");
  EXPECT_EQ(error_with("[materials.a]\ntexture = \"text.png\"\n"),
            "3:11: " + text +
                ": expected an image, but it is not an image in a format known here; convert it to PNG, JPEG or EXR");
  EXPECT_EQ(error_with("[[object]]\ntype = \"box\"\nsize = \"1 1 1 mm\"\nrotation = \"w 3 deg\"\n"),
            "5:12: expected an axis and an angle, such as \"y 30 deg\", for \"rotation\", got \"w 3 deg\"");
  EXPECT_EQ(error_with("[[object]]\ntype = \"box\"\nsize = \"1 1 1 mm\"\nrotation = [\"y 3\"]\n"),
            "5:13: expected an angle with its unit, such as \"15 deg\", got \"3\" without a unit for \"rotation\"");
  EXPECT_EQ(error_with("[[object]]\ntype = \"box\"\nsize = \"1 1 1 mm\"\nfit = \"1 mm\"\nscale = 2\n"),
            "5:7: expected either \"fit\" or \"scale\", got both");
  EXPECT_EQ(error_with("[[shape.a]]\ntype = \"shape\"\nshape = \"a\"\n[[object]]\ntype = \"shape\"\nshape = \"a\"\n"),
            "4:9: expected a shape of other shapes, but \"a\" holds itself");
}

}  // namespace
}  // namespace holotrace
