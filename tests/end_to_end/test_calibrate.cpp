// holotrace calibrate by its command line: patterns, photographs of them by `show`, and the panel that they give.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "holotrace/io/scene/scene_file.h"
#include "support/program.h"

namespace holotrace {
namespace {

using test::Outcome;
using test::Workplace;

const char* assumed =
    "name = \"assumed\"\ncolumns = 128\nrows = 128\npitch = \"8 um\"\nlevels = 256\nfill_factor = 0.95\n";

TEST(CalibrateCommand, WritesAPanelFileThatTheProgramReads) {
  const Workplace here;
  here.write("assumed.toml", assumed);
  // 10 % too much phase, and a wavefront error.
  here.write("hidden.toml", std::string(assumed) +
                                "phase_range = \"396 deg\"\ndesign_wavelength = \"633 nm\"\n"
                                "aberration = [{ n = 2, m = 2, rms = \"0.4 rad\" }]\n");
  Outcome outcome =
      here.run({"calibrate", "patterns", "--slm", "assumed.toml", "--wavelength", "633 nm", "--distance", "50 mm",
                "--measured-levels", "5", "--level-patterns", "4", "--focus-patterns", "1", "-o", "patterns"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<std::string> names{"01_spots", "02_levels", "03_levels", "04_levels", "05_levels", "06_focus"};
  std::filesystem::create_directory(here.path("photos"));
  for (const std::string& name : names) {
    ASSERT_TRUE(here.has("patterns/" + name + ".png")) << name;
    outcome = here.run({"show", "patterns/" + name + ".png", "--slm", "hidden.toml", "--effects", "all", "--distance",
                        "50 mm", "--pixel", "6 um", "--bits", "16", "-o", "photos/" + name + ".png"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  here.write("mine_phase.csv", "of the user");
  outcome = here.run({"calibrate", "fit", "patterns/calibration.toml", "photos", "-o", "mine.toml", "--json", "--name",
                      "mine", "--aberration-order", "2", "--light-order", "1", "--amplitude-order", "0", "--samples",
                      "5000"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json facts = nlohmann::json::parse(outcome.out);
  EXPECT_NE(outcome.err.find("mine_phase.csv~"), std::string::npos) << outcome.err;
  EXPECT_EQ(here.read("mine_phase.csv~"), "of the user");
  EXPECT_NE(here.read("mine.toml").find("\n# holotrace_files [{\"name\":\"*_"), std::string::npos)
      << here.read("mine.toml");
  ASSERT_EQ(facts["levels"].size(), 5u);
  // 396° of 256 levels, by 255 of them; 0.02 rad is the limit of the tests of calibrate/.
  EXPECT_NEAR(facts["levels"][4]["phase_rad"].get<double>(), 396 * 3.14159265 / 180 * 255 / 256, 0.02);
  EXPECT_NEAR(facts["camera_scale"].get<double>(), 8.0 / 6, 1e-3);
  EXPECT_EQ(facts["photographs"].size(), names.size());
  const Slm slm = load_slm(here.path("mine.toml"));
  EXPECT_EQ(slm.name, "mine");
  EXPECT_NEAR(slm.effects.calibration.back().phase, 396 * 3.14159265 / 180 * 255 / 256, 0.02);
  ASSERT_EQ(slm.effects.aberration.size(), 3u);
  EXPECT_NEAR(slm.effects.aberration[2].rms, 0.4, 0.02);
  outcome = here.run({"info", "--slm", "mine.toml"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;

  std::filesystem::remove(here.path("photos/03_levels.png"));
  outcome = here.run({"calibrate", "fit", "patterns/calibration.toml", "photos", "-o", "mine.toml"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("got none of 03_levels"), std::string::npos) << outcome.err;
  outcome = here.run({"calibrate", "fit", "patterns/calibration.toml", "photos", "-o", "patterns/calibration.toml"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("expected an output other than the input"), std::string::npos) << outcome.err;
  outcome = here.run({"calibrate", "fit", "patterns/calibration.toml", "photos", "-o", "mine.json"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find(".toml"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace holotrace
