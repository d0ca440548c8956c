#include <gtest/gtest.h>

#include "holotrace/data/params/parameter.h"
#include "holotrace/io/scene/scene_file.h"
#include "support/bounds.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

const std::string head =
    "wavelength = \"532 nm\"\n[[object]]\ntype = \"quad\"\nwidth = \"1 mm\"\nheight = \"1 mm\"\n"
    "position = \"0 0 -50 mm\"\n";

// The error for an additional line in a section of a scene, without the folder of the file.
std::string sentence_for(const std::string& lines) {
  const std::string path = test::make_file("scene.toml", head + lines);
  std::string sentence = error_of([&] { load_job(path); });
  const std::string folder = path.substr(0, path.rfind('/') + 1);
  if (sentence.starts_with(folder)) sentence.erase(0, folder.size());
  return sentence;
}

template <class Params>
void expect_bounds(const std::string& section) {
  const std::vector<test::Try> tries = test::bounds_of<Params>();
  ASSERT_GE(tries.size(), 2u) << section;
  for (const test::Try& t : tries) {
    const std::string value = t.has_quotes ? "\"" + t.text + "\"" : t.text;
    const std::string sentence = sentence_for("[" + section + "]\n" + t.key + " = " + value + "\n");
    if (t.is_inside) {
      EXPECT_EQ(sentence, "no error") << section << "." << t.key << " = " << value;
    } else {
      // The key is on line 8, its value after "key = ".
      const std::string place = fmt::format("scene.toml:8:{}: expected ", t.key.size() + 4);
      EXPECT_EQ(sentence.substr(0, place.size()), place) << section << "." << t.key << " = " << value;
      EXPECT_NE(sentence.find("\"" + t.key + "\", got "), std::string::npos) << sentence;
    }
  }
  EXPECT_EQ(error_of([] { check_ranges(Params{}); }), "no error") << section << ": the defaults";
}

TEST(Ranges, OfEveryParameterHoldInSceneFiles) {
  expect_bounds<TraceParams>("trace");
  expect_bounds<RenderParams>("render");
  expect_bounds<SynthesizeParams>("synthesize");
  expect_bounds<EncodeParams>("encode");
  expect_bounds<ShowParams>("show");
  expect_bounds<PropagateParams>("propagate");
  expect_bounds<CameraParams>("camera");
}

TEST(Ranges, AreWrittenInWords) {
  const auto sentence = [](double value, const Range& range, Quantity quantity) {
    return error_of([&] { check_range(value, range, quantity); });
  };
  EXPECT_EQ(sentence(0, range::positive, Quantity::length), "expected a length above 0 m, got 0 m");
  EXPECT_EQ(sentence(-532e-9, range::positive, Quantity::length), "expected a length above 0 m, got -532 nm");
  EXPECT_EQ(sentence(2e6, range::not_negative, Quantity::length), "expected a length of at most 1e+06 m, got 2e+06 m");
  EXPECT_EQ(sentence(-2e6, range::any, Quantity::length), "expected a length of at most 1e+06 m, got -2e+06 m");
  EXPECT_EQ(sentence(1e308, range::not_negative, Quantity::number), "expected a number of at most 1e+18, got 1e+308");
  EXPECT_EQ(sentence(1e18, range::not_negative, Quantity::number), "no error");
  EXPECT_EQ(sentence(-1, range::not_negative, Quantity::count), "expected a whole number of 0 or more, got -1");
  EXPECT_EQ(sentence(1.5, range::fraction, Quantity::number), "expected a number from 0 to 1, got 1.5");
  EXPECT_EQ(sentence(0, range::above_to(0, 1), Quantity::number), "expected a number above 0, up to 1, got 0");
  EXPECT_EQ(sentence(1, range::between(0, 1), Quantity::number), "expected a number above 0 and below 1, got 1");
  EXPECT_EQ(sentence(std::numbers::pi / 2, range::half_angle, Quantity::angle),
            "expected an angle from 0 deg to less than 90 deg, got 90 deg");
  EXPECT_EQ(sentence(1, range::or_value(0, range::from_to(2, 65536)), Quantity::count),
            "expected 0 or 2 to 65536, got 1");
  EXPECT_EQ(sentence(12, range::or_value(8, range::from_to(16, 16)), Quantity::count), "expected 8 or 16, got 12");
  EXPECT_EQ(sentence(std::nan(""), range::any, Quantity::length), "expected a length, got nan m");
  EXPECT_EQ(sentence(HUGE_VAL, range::not_negative, Quantity::number), "expected a number of 0 or more, got inf");
  EXPECT_EQ(sentence(2, {.high = 1}, Quantity::number), "expected a number at most 1, got 2");
  EXPECT_EQ(sentence(1, {.high = 1, .is_high_open = true}, Quantity::number), "expected a number below 1, got 1");
}

// Keys of scene files that are in no list of parameters.
TEST(Ranges, OfTheOtherKeysHoldInSceneFiles) {
  const auto object = [](const std::string& rest) {
    return sentence_for("[[object]]\nposition = \"0 0 -50 mm\"\n" + rest + "\n");
  };
  const auto slm = [](const std::string& rest) { return sentence_for("[slm]\npreset = \"pluto\"\n" + rest + "\n"); };
  EXPECT_EQ(object("size = \"-1 mm\"\ntype = \"sphere\""),
            "scene.toml:9:8: expected a length above 0 m for \"size\", got -1 mm");
  EXPECT_EQ(object("size = \"1 -1 1 mm\"\ntype = \"box\""),
            "scene.toml:9:8: expected a length above 0 m for \"size\", got -1 mm");
  EXPECT_EQ(object("width = \"0 mm\"\nheight = \"1 mm\"\ntype = \"quad\""),
            "scene.toml:9:9: expected a length above 0 m for \"width\", got 0 m");
  EXPECT_EQ(object("fit = \"0 m\"\nsize = \"1 mm\"\ntype = \"sphere\""),
            "scene.toml:9:7: expected a length above 0 m for \"fit\", got 0 m");
  EXPECT_EQ(object("scale = 0\nsize = \"1 mm\"\ntype = \"sphere\""),
            "scene.toml:9:9: expected a number above 0 for \"scale\", got 0");
  EXPECT_EQ(object("segments = 2\nsize = \"1 mm\"\ntype = \"sphere\""),
            "scene.toml:9:12: expected a whole number from 3 to 4096 for \"segments\", got 2");
  EXPECT_EQ(object("points_per_edge = 1\nsize = \"1 mm\"\ntype = \"wireframe_cube\""),
            "scene.toml:9:19: expected a whole number from 2 to 4096 for \"points_per_edge\", got 1");
  EXPECT_EQ(object("distance = \"-1 mm\"\nsize = \"1 mm\"\ntype = \"sphere\""),
            "scene.toml:9:12: expected a length of 0 m or more for \"distance\", got -1 mm");
  EXPECT_EQ(slm("pitch = \"0 um\""), "scene.toml:9:9: expected a length above 0 m for \"pitch\", got 0 m");
  EXPECT_EQ(slm("columns = 0"), "scene.toml:9:11: expected a whole number of 1 or more for \"columns\", got 0");
  EXPECT_EQ(slm("levels = 1"), "scene.toml:9:10: expected a whole number from 2 to 65536 for \"levels\", got 1");
  EXPECT_EQ(slm("fill_factor = 1.01"),
            "scene.toml:9:15: expected a number above 0, up to 1 for \"fill_factor\", got 1.01");
  EXPECT_EQ(slm("phase_range = \"0 rad\""),
            "scene.toml:9:15: expected an angle above 0 deg for \"phase_range\", got 0 deg");
  EXPECT_EQ(slm("design_wavelength = \"-1 nm\""),
            "scene.toml:9:21: expected a length of 0 m or more for \"design_wavelength\", got -1 nm");
  EXPECT_EQ(slm("dead_seed = -1"), "scene.toml:9:13: expected a whole number of 0 or more for \"dead_seed\", got -1");
  EXPECT_EQ(sentence_for("[[light]]\ntype = \"laser-beam\"\nradius = \"0 m\"\nposition = \"0 0 0 m\"\n"
                         "direction = [0, 0, -1]\nirradiance = 1\n"),
            "scene.toml:9:10: expected a length above 0 m for \"radius\", got 0 m");
  const std::string path = test::make_file("w.toml", "wavelength = \"-532 nm\"\n");
  EXPECT_EQ(error_of([&] { load_job(path); }),
            path + ":1:14: expected a length above 0 m for \"wavelength\", got -532 nm");
}

}  // namespace
}  // namespace holotrace
