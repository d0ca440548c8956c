// What a newcomer types first, and what the program says to it.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "end_to_end/expect_error.h"
#include "end_to_end/scenes.h"
#include "end_to_end/succeed.h"
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

}  // namespace
}  // namespace holotrace::test
