// The folder of a run in show, info and compare.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "end_to_end/expect_error.h"
#include "end_to_end/scenes.h"
#include "end_to_end/succeed.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/png.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

using Json = nlohmann::json;

// Two squares at 28 and 32 mm in two colours and two frames, seen at both distances through a pupil beside the axis.
std::string two_planes() {
  return "wavelength = [\"638 nm\", \"532 nm\"]\n[slm]\ncolumns = 160\nrows = 96\npitch = \"8 um\"\n"
         "[trace]\ncolumns = 48\nrows = 32\npaths = 2\nframes = 2\n"
         "[render]\nrows = 48\npaths = 8\nreference = \"full\"\n"
         "[camera]\ndistances = \"28 32 mm\"\npupil = \"1.2 mm\"\neye = \"0.1 -0.05 20 mm\"\n"
         "[[light]]\ntype = \"rectangle\"\ncorner = \"-5 -5 5 mm\"\nedge_u = \"0 10 0 mm\"\nedge_v = \"10 0 0 mm\"\nradiance = 5\n"
         "[[object]]\ntype = \"quad\"\nwidth = \"0.4 mm\"\nheight = \"0.4 mm\"\nposition = \"-0.25 0 -28 mm\"\n"
         "[[object]]\ntype = \"quad\"\nwidth = \"0.4 mm\"\nheight = \"0.4 mm\"\nposition = \"0.25 0 -32 mm\"\n";
}

TEST(RunFolder, ShowMakesTheViewsOfTheRunAgain) {
  const Workplace work;
  work.write("scene.toml", two_planes());
  // The exposure of a run is common to views and render, so it is given.
  succeed(work, {"run", "scene.toml", "-o", "out", "--exposure", "30"});
  ASSERT_TRUE(work.has("out/hologram_4.png") && !work.has("out/hologram_5.png"));
  succeed(work, {"show", "out", "-o", "view.png", "--exposure", "30"});
  for (const char* name : {"view.png", "view_2.png"})
    EXPECT_TRUE(work.read(name) == work.read(std::string("out/") + name)) << name;
  // Any flag replaces its own value only: the second distance through the same pupil.
  succeed(work, {"show", "out", "-o", "far.png", "--exposure", "30", "--distance", "32 mm"});
  EXPECT_EQ(load_image(work.path("far.png")).values, load_image(work.path("out/view_2.png")).values);
  EXPECT_FALSE(work.has("far_2.png"));
  succeed(work, {"show", "out", "-o", "whole.png", "--exposure", "30", "--distance", "32 mm", "--pupil", "0 mm",
                 "--eye", "0 0 0 mm"});
  EXPECT_NE(load_image(work.path("whole.png")).values, load_image(work.path("far.png")).values);
  // A single hologram knows it, too, and one of an earlier version is in focus at 300 mm, as ever.
  succeed(work, {"show", "out/hologram_3.png", "-o", "one.png", "--report", "one.json"});
  EXPECT_TRUE(work.has("one_2.png"));
  EXPECT_NE(work.read("one.json").find("look at 28 mm"), std::string::npos);
  Hologram earlier = load_hologram(work.path("out/hologram.png"));
  earlier.viewing = {};
  save_hologram(work.path("earlier.png"), earlier);
  succeed(work, {"show", "earlier.png", "-o", "one.png", "--report", "one.json"});
  EXPECT_NE(work.read("one.json").find("look at 300 mm"), std::string::npos);
}

TEST(RunFolder, InfoTellsWhatItHolds) {
  const Workplace work;
  work.write("scene.toml", two_planes());
  succeed(work, {"run", "scene.toml", "-o", "out"});
  const Json facts = Json::parse(succeed(work, {"info", "out", "--json"}));
  EXPECT_EQ(facts.at("kind"), "run");
  EXPECT_EQ(facts.at("holograms"), 4);
  EXPECT_EQ(facts.at("frames"), 2);
  EXPECT_EQ(facts.at("wavelength"), "638 nm, 532 nm");
  EXPECT_EQ(facts.at("pixels"), "160x96");
  EXPECT_EQ(facts.at("distances"), "28 mm, 32 mm");
  EXPECT_EQ(facts.at("pupil"), "1.2 mm");
  EXPECT_EQ(facts.at("eye"), "100 µm, -50 µm, 20 mm");
  EXPECT_EQ(facts.at("views"), 2);
  const Json report = Json::parse(work.read("out/report.json"));
  for (const Json& stage : report["stages"]) {
    if (stage["stage"] != "look at 32 mm") continue;
    const std::string words = facts.at("view_2.png at 32 mm");
    EXPECT_EQ(
        words.find(fmt::format("PSNR {:.1f} dB against the render (a black view: ", stage["psnr_db"].get<double>())),
        0u)
        << words;
    EXPECT_NE(
        words.find(fmt::format("{:.2g} % of the view are lit", 100 * stage["lit_fraction_of_view"].get<double>())),
        std::string::npos)
        << words;
  }
  EXPECT_EQ(facts.at("seconds"), report["seconds"]);
  const Json one = Json::parse(succeed(work, {"info", "out/hologram_2.png", "--json"}));
  EXPECT_EQ(one.at("kind"), "hologram");
  EXPECT_EQ(one.at("distances"), "28 mm, 32 mm");
}

TEST(RunFolder, CompareFindsForItsViewsWhatTheReportSays) {
  const Workplace work;
  work.write("scene.toml", two_planes());
  succeed(work, {"run", "scene.toml", "-o", "out", "--exposure", "200", "--bits", "16"});  // no view is clipped
  const Json views = Json::parse(succeed(work, {"compare", "out", "--json", "--difference", "d.png"})).at("views");
  ASSERT_EQ(views.size(), 2u);
  const Json report = Json::parse(work.read("out/report.json"));
  for (size_t i = 0; i < 2; ++i) {
    const std::string distance = i == 0 ? "28 mm" : "32 mm";
    EXPECT_EQ(views[i].at("distance"), distance);
    EXPECT_EQ(views[i].at("view"), i == 0 ? "out/view.png" : "out/view_2.png");
    for (const Json& stage : report["stages"]) {
      if (stage["stage"] != "look at " + distance) continue;
      // render.exr holds the floats that the run compared, and the views have steps of 16 bits.
      EXPECT_EQ(views[i].at("psnr_of_run_db"), stage.at("psnr_db"));
      for (const char* name : {"psnr_db", "psnr_of_black_db", "ssim", "speckle_contrast"})
        EXPECT_NEAR(views[i].at(name).get<double>(), stage.at(name).get<double>(), 2e-3) << name;
    }
  }
  EXPECT_TRUE(work.has("d.png") && work.has("d_2.png"));
}

TEST(RunFolder, CompareTakesTwo) {
  const Workplace work;
  work.write("scene.toml", two_planes());
  succeed(work, {"run", "scene.toml", "-o", "a"});
  succeed(work, {"run", "scene.toml", "-o", "b", "--frames", "1"});
  succeed(work, {"run", "scene.toml", "-o", "c", "--distance", "28 33 mm"});
  succeed(work, {"run", "scene.toml", "-o", "d", "--distance", "28 mm"});
  const std::string text = succeed(work, {"compare", "a", "a"});
  EXPECT_NE(text.find("psnr_db                      infinite"), std::string::npos) << text;
  const Json views = Json::parse(succeed(work, {"compare", "a", "b", "--json"})).at("views");
  ASSERT_EQ(views.size(), 2u);
  EXPECT_EQ(views[1].at("reference"), "a/view_2.png");
  EXPECT_EQ(views[1].at("view"), "b/view_2.png");
  EXPECT_EQ(views[1].at("distance"), "32 mm");
  // The same two files by name.
  const Json alone = Json::parse(succeed(work, {"compare", "a/view_2.png", "b/view_2.png", "--json"}));
  for (const char* name : {"psnr_db", "ssim", "scale"}) EXPECT_EQ(views[1].at(name), alone.at(name)) << name;
  expect_error(work, {"compare", "a", "c"}, {"a/view_2.png is in focus at 32 mm", "c/view_2.png at 33 mm"});
  expect_error(work, {"compare", "a", "d"}, {"as many views, got 2 in a and 1 in d"});
  expect_error(work, {"compare", "a", "b/view.png"}, {"two files, or the folders of two runs", "the folder a"});
  expect_error(work, {"compare", "a", "--register"}, {"--register", "name its view"});
}

TEST(RunFolder, OneWithoutARunIsRefusedInOneSentence) {
  const Workplace work;
  std::filesystem::create_directories(work.path("empty"));
  const Words words{"expected the folder of a run", "empty holds no hologram.png", "`holotrace run -o`"};
  expect_error(work, {"show", "empty", "-o", "v.png"}, words);
  expect_error(work, {"info", "empty"}, words);
  expect_error(work, {"compare", "empty"}, words);
  expect_error(work, {"info", "missing"}, {"no such file"});
  work.write("scene.toml", two_planes());
  succeed(work, {"run", "scene.toml", "-o", "out", "--reference", "none"});
  expect_error(work, {"compare", "out"}, {"the render of out/view.png", "--reference full"});
  Json report = Json::parse(work.read("out/report.json"));
  report["complete"] = false;
  work.write("out/report.json", report.dump());
  expect_error(work, {"show", "out", "-o", "v.png"}, {"a complete run", "run it again"});
  EXPECT_EQ(work.run({"compare", "scene.toml"}).exit_code, 2);  // wrong usage: one file alone
}

// A dot of 40 µm in 2.56 × 1.92 mm is 0.03 % of the picture: a black view would have 35 dB.
TEST(RunFolder, ARunOfOneDotWarnsThatItsFiguresSayLittle) {
  const Workplace work;
  const std::string scene =
      "wavelength = \"532 nm\"\n[slm]\ncolumns = 320\nrows = 240\npitch = \"8 um\"\n"
      "[trace]\ncolumns = 96\nrows = 72\npaths = 2\n[render]\nreference = \"full\"\nrows = 240\npaths = 2\n"
      "[camera]\ndistances = \"30 mm\"\n[[light]]\ntype = \"point\"\nposition = \"0 0 -10 mm\"\nintensity = 1e-3\n"
      "[[object]]\ntype = \"quad\"\nposition = \"0 0 -30 mm\"\n";
  work.write("dot.toml", scene + "width = \"0.04 mm\"\nheight = \"0.04 mm\"\n");
  const Outcome dot = work.run({"run", "dot.toml", "-o", "dot"});
  ASSERT_EQ(dot.exit_code, 0) << dot.err;
  EXPECT_NE(dot.err.find("of the render is lit, less than 0.1 %, so PSNR and SSIM say little"), std::string::npos)
      << dot.err;
  const Json report = Json::parse(work.read("dot/report.json"));
  bool is_found = false;
  for (const Json& stage : report["stages"]) {
    if (stage["stage"] != "look at 30 mm") continue;
    is_found = true;
    EXPECT_LT(stage["lit_fraction_of_render"].get<double>(), 0.001);
    EXPECT_GT(stage["psnr_of_black_db"].get<double>(), 30);  // 10·lg 1000
    EXPECT_EQ(stage["warnings"].size(), 1u);
  }
  EXPECT_TRUE(is_found);
  work.write("large.toml", scene + "width = \"1 mm\"\nheight = \"1 mm\"\n");
  succeed(work, {"run", "large.toml", "-o", "large"});  // without a warning
}

TEST(RunFolder, EncodeKeepsTheDistancesOfItsTargets) {
  const Workplace work;
  work.write("scene.toml", two_planes());
  succeed(work, {"render", "scene.toml", "--focal-stack", "28 32 mm", "-o", "stack.h5"});
  work.write("panel.toml", "columns = 160\nrows = 96\npitch = \"8 um\"\n");
  succeed(work, {"encode", "stack.h5", "--method", "sgd", "--iterations", "2", "--slm", "panel.toml", "--wavelength",
                 "532 nm", "-o", "h.png"});
  EXPECT_EQ(viewing_of_file(work.path("h.png")).distances, (std::vector<double>{0.028, 0.032}));
  succeed(work, {"field", "scene.toml", "--wavelength", "532 nm", "-o", "f.npy"});
  succeed(work, {"encode", "f.npy", "--method", "gerchberg-saxton", "--iterations", "1", "--target-distances", "31 mm",
                 "-o", "g.png"});
  EXPECT_EQ(viewing_of_file(work.path("g.png")).distances, std::vector<double>{0.031});
  succeed(work, {"encode", "f.npy", "-o", "p.png"});
  EXPECT_FALSE(viewing_of_file(work.path("p.png")).are_known());  // the field on the panel has no target
}

}  // namespace
}  // namespace holotrace::test
