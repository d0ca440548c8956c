// Help texts, wrong flags, and names of earlier versions.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "end_to_end/scenes.h"
#include "end_to_end/succeed.h"
#include "holotrace/base/units.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/wave/propagate/propagate.h"
#include "support/png.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

using namespace literals;

// `bench` itself runs in test_bench.cpp, on its small jobs.
TEST(Commands, EveryHelpTextNamesItsCommand) {
  const Workplace work;
  EXPECT_NE(succeed(work, {"--help"}).find("Usage"), std::string::npos);
  EXPECT_EQ(succeed(work, {"--version"}).substr(0, 10), "holotrace ");
  for (const std::string command : {"run", "render", "trace", "field", "encode", "show", "propagate", "compare",
                                    "limits", "estimate", "info", "bench"})
    EXPECT_NE(succeed(work, {command, "--help"}).find("holotrace " + command), std::string::npos) << command;
}

// The help of the largest command fits on a screen; the rest is one flag away.
TEST(Commands, TheHelpOfRunHasExamplesAndCommonFlags) {
  const Workplace work;
  const std::string some = succeed(work, {"run", "--help"}), all = succeed(work, {"run", "--help-all"});
  EXPECT_LE(std::count(some.begin(), some.end(), '\n'), 40);
  for (const char* part :
       {"Examples:\n  holotrace run model.glb -o out\n", "--quality", "--eye", "--help-all", "SCENE"})
    EXPECT_NE(some.find(part), std::string::npos) << part;
  EXPECT_EQ(some.find("--roulette-depth"), std::string::npos);
  for (const char* part : {"--roulette-depth", "--quality", "Encoding (overrides the scene's [encode]):"})
    EXPECT_NE(all.find(part), std::string::npos) << part;
}

TEST(Commands, EveryStageWritesItsReport) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const std::vector<std::pair<std::string, std::vector<std::string>>> stages{
      {"render", {"render", "scene.toml", "-o", "r.exr"}},
      {"trace", {"trace", "scene.toml", "-o", "s.ply"}},
      {"synthesize", {"field", "scene.toml", "-o", "f.npy"}},
      {"propagate", {"propagate", "f.npy", "--distance", "5 mm", "-o", "g.npy"}},
      {"encode", {"encode", "f.npy", "-o", "h.png"}},
      {"show", {"show", "h.png", "-o", "v.png"}}};
  for (const auto& [stage, command] : stages) {
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), {"--report", "report.json"});
    succeed(work, arguments);
    const auto report = nlohmann::json::parse(work.read("report.json"));
    std::vector<std::string> names;
    for (const auto& one : report.at("stages")) {
      names.push_back(one.at("stage"));
      EXPECT_GT(one.at("seconds").get<double>(), 0) << stage;
    }
    EXPECT_NE(std::find(names.begin(), names.end(), stage), names.end()) << stage;
  }
}

TEST(Commands, ABlackRenderIsExplained) {
  const Workplace work;
  const std::string quad =
      "[render]\nrows = 16\npaths = 1\n[[object]]\ntype = \"quad\"\nwidth = \"2 mm\"\nheight = \"2 mm\"\n";
  work.write("dark.toml", scene_head(small_panel, "") + quad + "position = \"0 0 -32 mm\"\n");
  work.write("aside.toml", scene_head(small_panel, "") + quad + "position = \"90 0 -32 mm\"\n");
  EXPECT_EQ(
      work.run({"render", "dark.toml", "-o", "r.png"}).err,
      "warning: scene: the scene has no light: add [[light]], a material's emission, or a background\n"
      "warning: render: the picture is black: every first hit is dark; add lights, emission or a background to the "
      "scene\n");
  EXPECT_NE(work.run({"render", "aside.toml", "-o", "r.png"}).err.find("no ray met a surface"), std::string::npos);
}

TEST(Commands, WrongUsageExitsWith2AndSaysWhatIsWrong) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{}, "expected a command, got none; known: run, render"},
      {{"rnder", "scene.toml"}, "did you mean \"render\""},
      {{"run", "scene.toml"}, "expected --output DIR, got none"},
      {{"run", "-o", "out"}, "expected SCENE.toml|MESH|PICTURES (scene), got none"},
      {{"field", "scene.toml", "-o", "f.npy", "--tolerence", "1e-3"},
       "unknown flag \"--tolerence\"; did you mean \"--tolerance\"?"},
      {{"field", "scene.toml", "--tolerence=1e-3"}, "did you mean \"--tolerance\"?"},  // before --output is missed
      {{"run", "scene.toml", "--otput", "x"}, "did you mean \"--output\"?"},
      {{"limits", "--thraeds", "2"}, "did you mean \"--threads\"?"},  // a flag of the program
      {{"calibrate", "fti"}, "unknown command \"fti\"; did you mean \"fit\"?"},
      {{"calibrate", "fit", "p.toml", "d", "-o", "p.toml", "--jsno"}, "did you mean \"--json\"?"},
      {{"run", "scene.toml", "--frames", "1", "--binning", "1"}, "unknown flag \"--binning\""},  // 1 is its value
      {{"run", "scene.toml", "--frames", "1", "1"}, "expected no further argument, got \"1\""},
      {{"compare", "not", "expected", "c"}, "expected no further argument, got \"c\""},  // words of CLI11's message
      {{"--frames", "1", "run", "scene.toml", "-o", "x"},
       "expected --frames after the command, got it before; write `holotrace run … --frames`"},
      {{"bench", "-z"}, "unknown flag \"-z\"; `holotrace bench --help` lists the flags"},
      {{"run", "scene.toml", "-o", "x", "--seed", "1.5"}, "--seed: expected a whole number, got \"1.5\""},
      {{"field", "scene.toml", "-o", "f.npy", "--double=yes!"}, "--double: expected no value, got \"yes!\""},
      {{"run", "scene.toml", "-o", "x", "--method"}, "expected --method auto|phase|"},
      {{"run", "scene.toml", "-o", "x", "-o", "y"}, "expected --output once, got it 2 times"},
      {{"field", "scene.toml", "extra", "-o", "f.npy"},
       "expected no further argument, got \"extra\"; `holotrace field --help` lists the arguments"},
      {{"propagate", "f.npy", "-o", "g.npy"}, "expected --distance LENGTH, got none"},
      {{"compare", "a.png"}, "expected B (b), or the folder of a run as A, got none"},
      {{"info", "scene.toml", "--threads", "-1"}, "whole number of 0 or more"},
      {{"info"}, "expected a file or folder, --slm, --lights or --devices, got none"},
      {{"info", "scene.toml", "--lights"}, "--lights excludes a file"},
      {{"info", "--slm", "--lights"}, "--lights excludes --slm"},
      {{"info", "--slm", "pluto", "leto"}, "file excludes --slm"},
      {{"show", "h.png", "-o"}, "--output"},
  };
  for (const auto& [arguments, sentence] : cases) {
    const Outcome outcome = work.run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << sentence;
    EXPECT_NE(outcome.err.find(sentence), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
  EXPECT_EQ(work.names(), std::set<std::string>{"scene.toml"});
}

// Names that flags and keys had before are read, with one line of warning, and give the same bytes as the new ones.
TEST(Commands, OldNamesAreReadWithAWarning) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.03}}}));
  work.write("scene.toml", scene_head() + points_object());
  succeed(work, {"field", "scene.toml", "-o", "f.npy"});
  succeed(work, {"encode", "f.npy", "-o", "h.png"});
  const std::vector<std::string> show{"show", "h.png", "--distance", "30 mm", "--bandwidth", "4 nm"};
  const auto run = [&](const std::string& flag, const std::string& output) {
    std::vector<std::string> arguments = show;
    arguments.insert(arguments.end(), {flag, "9", "-o", output});
    return work.run(arguments);
  };
  const Outcome before = run("--moments", "before.png"), now = run("--illumination-states", "now.png");
  EXPECT_EQ(before.exit_code, 0);
  EXPECT_EQ(before.err, "warning: `--moments` is now called `--illumination-states`; the old name is still read\n");
  EXPECT_EQ(now.err, "");
  EXPECT_EQ(work.read("before.png"), work.read("now.png"));

  std::vector<std::string> both = show;
  both.insert(both.end(), {"--moments", "9", "--illumination-states", "9", "-o", "both.png"});
  EXPECT_EQ(work.run(both).exit_code, 2);  // wrong usage
  const std::string help = work.run({"show", "--help"}).out;
  EXPECT_EQ(help.find("--moments"), std::string::npos);
  EXPECT_EQ(help.find("Excludes:"), std::string::npos);  // by a name that is not shown

  work.write("old.toml", mesh_scene() + "[show]\nmoments = 1\n");
  const Outcome traced = work.run({"trace", "old.toml", "-o", "sources.ply"});
  EXPECT_EQ(traced.exit_code, 0);
  EXPECT_EQ(std::count(traced.err.begin(), traced.err.end(), '\n'), 1) << traced.err;
  EXPECT_NE(traced.err.find("`moments` is now called `illumination_states`"), std::string::npos);
  EXPECT_NE(work.run({"run", "old.toml", "-o", "out"}).err.find("`moments` is now called"), std::string::npos);
}

}  // namespace
}  // namespace holotrace::test
