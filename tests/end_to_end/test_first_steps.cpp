// What a newcomer types first, and what the program says to it.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "end_to_end/expect_error.h"
#include "end_to_end/scenes.h"
#include "end_to_end/succeed.h"
#include "holotrace/io/picture/image_file.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

constexpr const char* panel_file = "columns = 32\nrows = 24\npitch = \"8 um\"\n";
constexpr const char* square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

// A run of few iterations of the square on the small panel.
std::vector<std::string> quick_run(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"run", "m.obj",   "--slm", "p.toml", "--iterations",
                                     "2",   "--paths", "1",     "-o",     "out"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

void save_grey(const std::string& path, int rows, int columns) {
  Image picture(rows, columns, 1);
  picture.values.assign(picture.values.size(), 0.5F);
  save_image(path, picture, 1, 8);
}

void expect_words(const Workplace& work, const std::vector<std::string>& arguments, const std::string& words) {
  const Outcome outcome = work.run(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
}

TEST(FirstSteps, APanelFileIsDescribedAndIsNoScene) {
  const Workplace work;
  work.write("p.toml", panel_file);
  const auto facts = nlohmann::json::parse(succeed(work, {"info", "p.toml", "--json"}));
  EXPECT_EQ(facts.at("kind"), "panel");
  EXPECT_EQ(facts.at("pixels"), "32x24");
  expect_error(work, {"run", "p.toml", "-o", "out"},
               {"expected a scene or a model, got a panel file; name it by --slm p.toml"});
}

TEST(FirstSteps, APageIsNoScene) {
  const Workplace work;
  work.write("README.md", "# Holotrace\n\nHolotrace turns 3D scenes into holograms.\n");
  expect_error(work, {"run", "README.md", "-o", "out"}, {"expected a scene .toml or a model such as .obj or .glb"});
}

TEST(FirstSteps, AnEstimateTakesAModelAndItsPanel) {
  const Workplace work;
  work.write("m.obj", square);
  work.write("p.toml", panel_file);
  const auto cost = nlohmann::json::parse(
      succeed(work, {"estimate", "m.obj", "--slm", "p.toml", "--set", "fit=0.5", "--floor", "none", "--json"}));
  EXPECT_EQ(cost.at("holograms"), 1);
}

TEST(FirstSteps, PictureAndHologramAreToldApart) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  succeed(work, {"run", "scene.toml", "-o", "out"});
  expect_error(
      work, {"encode", "out/hologram.png", "-o", "p.bmp"},
      {"got the hologram out/hologram.png; holotrace display out/hologram.png -o p.bmp writes it in another format"});
  expect_words(work, {"display", "out/view.png", "-o", "q.bmp"}, "has no metadata: its greys are taken as levels");
  succeed(work, {"display", "out/hologram.png", "-o", "p.bmp"});
  succeed(work, {"display", "out/view.png", "--levels", "256", "-o", "r.bmp"});
}

TEST(FirstSteps, WhatHasNoEffectIsAWarning) {
  const Workplace work;
  work.write("m.obj", square);
  work.write("p.toml", panel_file);
  expect_words(work, quick_run({"--columns", "16", "--rows", "8"}), "rays of the trace, not pixels of the panel");
  expect_words(work, {"show", "out/hologram.png", "--eye", "5 3 250 mm", "-o", "v.png"},
               "the eye has no effect without a pupil");
  succeed(work, {"show", "out/hologram.png", "--eye", "0 0 250 mm", "--pupil", "1 mm", "-o", "v.png"});
  succeed(work, {"show", "out/hologram.png", "-o", "v.png"});
}

TEST(FirstSteps, APupilBesideTheLightIsAWarning) {
  const Workplace work;
  work.write("m.obj", square);
  work.write("p.toml", panel_file);
  const Outcome run = work.run(quick_run({}));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const std::string advice = "for a better picture: --quality good, or more --frames";
  EXPECT_NE(run.out.find(advice), std::string::npos) << run.out;
  expect_words(work, {"show", "out/hologram.png", "--eye", "0 0 250 mm", "--pupil", "1 mm", "-o", "v.png"},
               "found for all light that leaves the panel");
  succeed(work, {"show", "out/hologram.png", "-o", "v.png"});
}

TEST(FirstSteps, ASceneWithoutLightIsAWarning) {
  const Workplace work;
  work.write("dark.toml", scene_head() + "[[object]]\ntype = \"sphere\"\nsize = \"1 mm\"\nposition = \"0 0 -30 mm\"\n");
  expect_words(work, {"render", "dark.toml", "--rows", "8", "--columns", "8", "-o", "r.png"},
               "the scene has no light: add [[light]], a material's emission, or a background");
}

TEST(FirstSteps, AMisspeltCommandOfCommandsIsNamed) {
  const Workplace work;
  const Outcome outcome = work.run({"calibrate", "pattern", "--slm", "pluto"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("unknown command \"pattern\"; did you mean \"patterns\"?"), std::string::npos)
      << outcome.err;
}

// The example scenes come with the program. A copy that the user changed is never lost.
TEST(FirstSteps, ExamplesAreListedAndCopied) {
  const Workplace work;
  const std::string list = succeed(work, {"examples"});
  EXPECT_NE(list.find("chess_film.toml"), std::string::npos) << list;
  EXPECT_NE(list.find("The chess game of Fig. 10 on a quarter of the panel"), std::string::npos) << list;
  succeed(work, {"examples", "-o", "scenes"});
  succeed(work, {"info", "scenes/fig09_textured_quad.toml"});  // with its texture
  succeed(work, {"examples", "-o", "scenes"});
  work.write("scenes/candle.toml", "mine");
  expect_error(work, {"examples", "-o", "scenes"}, {"folder without changed examples, got scenes/candle.toml"});
  EXPECT_EQ(work.read("scenes/candle.toml"), "mine");
}

// A flag that takes true or false stands alone, before a file, too.
TEST(FirstSteps, AFlagOfTrueOrFalseNeedsNoValue) {
  const Workplace work;
  work.write("p.toml", panel_file);
  save_grey(work.path("picture.png"), 6, 8);
  const std::vector<std::string> rest{"--slm",        "p.toml", "--wavelength", "532 nm", "--target-distances", "8 mm",
                                      "--iterations", "1",      "-o",           "h.png"};
  const auto encode = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "encode");
    words.insert(words.end(), rest.begin(), rest.end());
    return words;
  };
  for (const auto& words : std::vector<std::vector<std::string>>{
           {"--resample", "picture.png"}, {"picture.png", "--resample"}, {"picture.png", "--resample", "true"}})
    succeed(work, encode(words));
  expect_error(work, encode({"picture.png", "--resample", "false"}), {"resample"});
  expect_error(work, encode({"picture.png", "--resample", "yes"}), {"--resample: expected true or false, got \"yes\""});
}

TEST(FirstSteps, APictureIsEncodedByIterations) {
  const Workplace work;
  work.write("p.toml", panel_file);
  save_grey(work.path("picture.png"), 24, 32);
  const std::string said = succeed(work, {"encode", "picture.png", "--slm", "p.toml", "--wavelength", "532 nm",
                                          "--target-distances", "8 mm", "--iterations", "2", "-o", "h.png"});
  EXPECT_NE(said.find("to see the picture: holotrace show h.png"), std::string::npos) << said;
  EXPECT_EQ(nlohmann::json::parse(succeed(work, {"info", "h.png", "--json"})).at("encoder"), "sgd");

  save_grey(work.path("flat.png"), 10, 20);  // becomes 16 x 32 pixels of 8 um
  std::vector<std::string> encode{
      "encode", "flat.png", "--slm", "p.toml",     "--wavelength", "532 nm", "--target-distances",
      "8 mm",   "-o",       "h.png", "--resample", "--method"};
  encode.push_back("double-phase");
  const std::string scaled = succeed(work, encode);
  EXPECT_NE(scaled.find("--width \"256 µm\" --height \"128 µm\""), std::string::npos) << scaled;
  encode.back() = "phase";
  expect_words(work, encode, "the method phase shows only the edges of a picture");
  encode.insert(encode.end(), {"--start", "random"});
  EXPECT_EQ(work.run(encode).err.find("edges"), std::string::npos);
}

// Iterated levels allow for the effects of a panel of one's own; levels whose greys are others are told.
TEST(FirstSteps, LevelsAllowForTheEffectsOfAPanelOfOnesOwn) {
  const Workplace work;
  work.write("p.toml", std::string(panel_file) +
                           "levels = 208\ncrosstalk = 0.2\naberration = [{ n = 2, m = 2, rms = \"0.5 rad\" }]\n");
  save_grey(work.path("picture.png"), 24, 32);
  const std::vector<std::string> encode{
      "encode", "picture.png",  "--slm", "p.toml", "--wavelength", "532 nm", "--target-distances",
      "8 mm",   "--iterations", "2",     "-o",     "h.png"};
  succeed(work, encode);
  EXPECT_EQ(load_hologram(work.path("h.png")).effects, (std::vector<std::string>{"crosstalk", "aberration"}));
  const std::string greys = "levels 0 to 207 are spread over the greys 0 to 255";
  EXPECT_NE(succeed(work, {"display", "h.png", "-o", "h.bmp"}).find(greys), std::string::npos);
  EXPECT_EQ(succeed(work, {"display", "h.png", "-o", "h.csv"}).find(greys), std::string::npos);
}

TEST(FirstSteps, APanelSaysWhichEffectsAreOn) {
  const Workplace work;
  work.write("p.toml", std::string(panel_file) + "crosstalk = 0.2\n");
  const auto effects = [&](const char* panel) {
    return nlohmann::json::parse(succeed(work, {"info", "--slm", panel, "--json"})).at("effects");
  };
  EXPECT_EQ(effects("p.toml"), "on: crosstalk");
  EXPECT_EQ(effects("pluto"), "off; turn them on with --effects all");
  expect_error(work, {"info", "--slm", "p"}, {"unknown SLM \"p\"; did you mean the panel file \"p.toml\"?"});
  work.write("wide.toml", "columns = 32\nrows = 24\npitch = \"8 mm\"\n");
  expect_error(work, {"info", "--slm", "wide.toml"}, {"pixels are at most 1 mm wide, got 8 mm; did you mean 8 um?"});
}

TEST(FirstSteps, AFilmOfWhatRestsIsAWarning) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  expect_words(work, {"animate", "scene.toml", "-o", "film", "--times", "0 s, 1 s"},
               "nothing in scene.toml changes with time, so all 2 pictures are alike");
}

}  // namespace
}  // namespace holotrace::test
