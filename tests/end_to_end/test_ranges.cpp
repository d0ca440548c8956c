#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "flags.h"
#include "holotrace/data/depth_image.h"
#include "holotrace/data/job.h"
#include "holotrace/view/register/register.h"
#include "support/bounds.h"
#include "support/program.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

using test::Outcome;
using test::Workplace;

template <class Params>
void expect_bounds() {
  const std::vector<test::Try> tries = test::bounds_of<Params>();
  ASSERT_GE(tries.size(), 2u);
  for (const test::Try& t : tries) {
    CLI::App app;
    Flags flags;
    flags.add(app, Params());
    const std::string argument = dashed(t.key) + "=" + t.text;
    std::vector<std::string> arguments{argument};
    app.parse(arguments);
    Params params;
    const std::string sentence = error_of([&] { flags.apply(params); });
    if (t.is_inside)
      EXPECT_EQ(sentence, "no error") << argument;
    else
      EXPECT_EQ(sentence.substr(0, dashed(t.key).size() + 11), dashed(t.key) + ": expected ") << argument;
  }
}

TEST(Ranges, OfEveryParameterHoldForFlags) {
  expect_bounds<TraceParams>();
  expect_bounds<RenderParams>();
  expect_bounds<SynthesizeParams>();
  expect_bounds<EncodeParams>();
  expect_bounds<ShowParams>();
  expect_bounds<PropagateParams>();
  expect_bounds<CameraParams>();
  expect_bounds<DepthImageParams>();
  expect_bounds<RegisterParams>();
}

// Flags that are in no list of parameters. One scene with a point serves all.
TEST(Ranges, OfTheOtherFlagsHold) {
  const Workplace work;
  work.write(
      "scene.toml",
      "wavelength = \"532 nm\"\n[slm]\npreset = \"ideal\"\ncolumns = 16\nrows = 16\npitch = \"8 um\"\n"
      "[[object]]\ntype = \"wireframe_cube\"\nsize = \"0.1 mm\"\npoints_per_edge = 2\nposition = \"0 0 -50 mm\"\n");
  ASSERT_EQ(work.run({"trace", "scene.toml", "-o", "s.ply"}).exit_code, 0);
  const auto expect = [&](const std::vector<std::string>& arguments, const std::string& sentence) {
    const Outcome outcome = work.run(arguments);
    EXPECT_EQ(outcome.exit_code, 1) << sentence;
    EXPECT_EQ(outcome.err, "holotrace: " + sentence + "\n");
  };
  const std::string no_wavelength = "--wavelength: expected a length above 0 m, got -532 nm";
  for (const char* command : {"run", "trace", "field"})
    expect({command, "scene.toml", "-o", "out.ply", "--wavelength", "-532 nm"}, no_wavelength);
  expect({"field", "s.ply", "-o", "f.npy", "--wavelength", "-532 nm"}, no_wavelength);
  expect({"limits", "--wavelength", "-532 nm"}, no_wavelength);
  expect({"field", "s.ply", "-o", "f.npy", "--pitch", "0 um"}, "--pitch: expected a length above 0 m, got 0 m");
  expect({"field", "s.ply", "-o", "f.npy", "--columns", "0"}, "--columns: expected a whole number of 1 or more, got 0");
  expect({"field", "s.ply", "-o", "f.npy", "--rows", "-3"}, "--rows: expected a whole number of 1 or more, got -3");
  expect({"run", "scene.toml", "-o", "out", "--seed", "-1"}, "--seed: expected a whole number of 0 or more, got -1");
  expect({"trace", "scene.toml", "-o", "t.ply", "--seed", "-1"},
         "--seed: expected a whole number of 0 or more, got -1");
  expect({"run", "scene.toml", "-o", "out", "--eye-separation", "-1 mm"},
         "--eye-separation: expected a length of 0 m or more, got -1 mm");
  expect({"limits", "--distance", "0 m"}, "--distance: expected a length above 0 m, got 0 m");
  expect({"limits", "--period", "-1 um"}, "--period: expected a length above 0 m, got -1 µm");
  expect({"limits", "--frames", "0"}, "--frames: expected a number above 0, got 0");
  expect({"limits", "--frames", "30", "--colours", "0"}, "--colours: expected a whole number of 1 or more, got 0");
  expect({"limits", "--angle", "90 deg"}, "--angle: expected an angle above 0 deg and below 90 deg, got 90 deg");
  expect({"limits", "--angle", "15 deg", "--size", "0 m"}, "--size: expected a length above 0 m, got 0 m");
  expect({"limits", "--angle", "15 deg", "--resolution", "0 m"}, "--resolution: expected a length above 0 m, got 0 m");
  expect({"estimate", "scene.toml", "--fps", "0"}, "--fps: expected a number above 0, up to 1000000, got 0");
  EXPECT_FALSE(work.has("out"));
}

TEST(Ranges, AreInTheHelpTexts) {
  const Workplace work;
  const std::string help = work.run({"trace", "--help"}).out;
  EXPECT_NE(help.find("(1 or more)"), std::string::npos) << help;
  EXPECT_NE(work.run({"field", "--help"}).out.find("(above 0 and below 1)"), std::string::npos);
}

}  // namespace
}  // namespace holotrace
