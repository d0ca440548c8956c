// The commands that plan and describe: limits, estimate, info.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "end_to_end/expect_error.h"
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

TEST(Commands, LimitsAreThePapers) {
  const Workplace work;
  const auto panel = nlohmann::json::parse(
      succeed(work, {"limits", "--slm", "pluto", "--wavelength", "532 nm", "--distance", "200 mm", "--json"}));
  EXPECT_NEAR(panel.at("half_angle_deg").get<double>(), 1.905, 5e-4);         // closed_forms.md, section 1
  EXPECT_NEAR(panel.at("alias_free_radius_m").get<double>() / 8e-6, 832, 1);  // the same section: 832 px
  const auto wanted =
      nlohmann::json::parse(succeed(work, {"limits", "--wavelength", "632.8 nm", "--angle", "15 deg", "--json"}));
  EXPECT_NEAR(wanted.at("wanted_pitch_m").get<double>(), 1.181e-6, 5e-10);  // the paper: 1.18 µm
}

TEST(Commands, APanelsOwnWavelengthIsTheUsualOne) {
  const Workplace work;
  work.write("green.toml", "preset = \"pluto\"\ndesign_wavelength = \"520 nm\"\n");
  const auto asked = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"limits", "--json"});
    return nlohmann::json::parse(succeed(work, flags)).at("wavelength_m").get<double>();
  };
  EXPECT_DOUBLE_EQ(asked({"--slm", "green.toml"}), 520e-9);
  EXPECT_DOUBLE_EQ(asked({"--slm", "green.toml", "--wavelength", "633 nm"}), 633e-9);
  EXPECT_DOUBLE_EQ(asked({"--angle", "15 deg"}), 632.8e-9);
  succeed(work, {"calibrate", "patterns", "--slm", "green.toml", "--level-patterns", "1", "-o", "patterns"});
  EXPECT_DOUBLE_EQ(load_hologram(work.path("patterns/01_spots.png")).wavelength, 520e-9);
}

TEST(Commands, LimitsTellGratingOrdersAndDataRates) {
  const Workplace work;
  const auto ask = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), "limits");
    flags.push_back("--json");
    return nlohmann::json::parse(succeed(work, flags));
  };
  const std::vector<std::string> grating{"--wavelength", "500 nm", "--distance", "300 mm", "--period", "2 um"};
  const auto first = ask(grating);
  EXPECT_DOUBLE_EQ(first.at("order_offset_m").get<double>(), 0.3 / std::sqrt(15));  // tan(asin(1/4)) = 1/√15
  EXPECT_TRUE(first.contains("half_angle_deg"));
  auto flags = grating;
  flags.insert(flags.end(), {"--order", "-2"});
  EXPECT_DOUBLE_EQ(ask(flags).at("order_offset_m").get<double>(), -0.3 / std::sqrt(3));  // −tan(asin(1/2))
  flags.back() = "4";
  EXPECT_TRUE(ask(flags).at("order_offset_m").is_null());  // sin θ = 1: evanescent, infinitely far

  const double pixels = 1920.0 * 1080;  // pluto and ideal
  const auto rate = ask({"--colours", "3", "--frames", "30"});
  EXPECT_EQ(rate.at("pixels_per_second").get<double>(), pixels * 90);
  EXPECT_EQ(rate.at("bytes_per_second").get<double>(), pixels * 90);                                        // 8 bit
  EXPECT_EQ(ask({"--slm", "ideal", "--frames", "60"}).at("bytes_per_second").get<double>(), pixels * 120);  // 16 bit
  const auto wanted = ask({"--angle", "15 deg", "--size", "100 mm", "--frames", "30", "--colours", "3"});
  EXPECT_EQ(wanted.at("pixels_per_second").get<double>(),
            std::pow(wanted.at("wanted_pixels_per_side").get<double>(), 2) * 90);
}

TEST(Commands, LimitsSayWhereAPanelHoldsEveryDirection) {
  const Workplace work;
  const auto coarse = nlohmann::json::parse(succeed(work, {"limits", "--wavelength", "15.9 um", "--json"}));
  EXPECT_FALSE(coarse.contains("note"));
  const auto fine = nlohmann::json::parse(succeed(work, {"limits", "--wavelength", "16 um", "--json"}));  // 2 pitches
  EXPECT_NE(fine.at("note").get<std::string>().find("every direction"), std::string::npos);
  EXPECT_EQ(fine.at("half_angle_deg").get<double>(), 90);
  EXPECT_TRUE(fine.at("alias_free_radius_m").is_null());
}

TEST(Commands, InfoKnowsEveryKindOfFile) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  succeed(work, {"run", "scene.toml", "-o", "out"});
  const std::vector<std::pair<std::string, std::string>> kinds{{"scene.toml", "scene"},
                                                               {"out/sources.ply", "sources"},
                                                               {"out/field.npy", "field"},
                                                               {"out/hologram.png", "hologram"},
                                                               {"out/view.png", "image"}};
  for (const auto& [file, kind] : kinds) {
    EXPECT_EQ(nlohmann::json::parse(succeed(work, {"info", file, "--json"})).at("kind"), kind) << file;
    EXPECT_NE(succeed(work, {"info", file}).find(kind), std::string::npos) << file;
  }
}

TEST(Commands, InfoSaysWhatWasDoneForAPanel) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  succeed(work, {"run", "scene.toml", "-o", "out"});
  succeed(work, {"display", "out/hologram.png", "-o", "panel.bmp", "--flip", "x"});
  const auto facts = nlohmann::json::parse(succeed(work, {"info", "panel.bmp", "--json"}));
  EXPECT_EQ(facts, nlohmann::json({{"kind", "picture for a panel"}, {"flip", "x"}}));
}

TEST(Commands, InfoKnowsThatANameIsThatOfAPanel) {
  const Workplace work;
  EXPECT_EQ(
      work.run({"info", "pluto"}).err,
      "holotrace: expected a file or folder at pluto, but there is none; pluto is a panel: holotrace info --slm pluto\n");
}

// A panel of the user's is marked and hides the built-in one of its name; one that cannot be read does not hide the others.
TEST(Commands, InfoListsPanels) {
  const Workplace work;
  work.write("panels/luna.toml", "preset = \"pluto\"\nsource = \"measured on the bench\"\nlevels = 64\n");
  work.write("panels/broken.toml", "preset = \"pluto\"\nlevles = 64\n");
  setenv("HOLOTRACE_PANELS", work.path("panels").c_str(), 1);
  const std::string table = succeed(work, {"info", "--slm"});
  const auto panels = nlohmann::json::parse(succeed(work, {"info", "--slm", "--json"})).at("panels");
  unsetenv("HOLOTRACE_PANELS");
  EXPECT_NE(table.find("  pluto "), std::string::npos) << table;
  EXPECT_NE(table.find("1920 x 1080     8 µm    256 phase       0.93  HOLOEYE PLUTO-2.1 data sheet\n"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("* luna "), std::string::npos) << table;
  EXPECT_NE(table.find("1920 x 1080     8 µm     64 phase       0.93  measured on the bench\n"), std::string::npos)
      << table;
  EXPECT_NE(table.find("* broken "), std::string::npos) << table;
  EXPECT_NE(table.find("unknown key \"levles\"; did you mean \"levels\"?"), std::string::npos) << table;
  EXPECT_NE(table.find("* from a folder of your own"), std::string::npos) << table;
  EXPECT_EQ(succeed(work, {"info", "--slm"}).find('*'), std::string::npos);
  std::map<std::string, nlohmann::json> by_name;
  for (const auto& panel : panels) by_name[panel.at("name")] = panel;
  EXPECT_TRUE(by_name.at("luna").at("is_own").get<bool>());
  EXPECT_EQ(by_name.at("luna").at("file"), work.path("panels/luna.toml"));
  EXPECT_TRUE(by_name.at("broken").contains("fault"));
  const nlohmann::json& dmd = by_name.at("ti-dlp7000");
  EXPECT_FALSE(dmd.at("is_own").get<bool>());
  EXPECT_EQ(dmd.at("columns"), 1024);
  EXPECT_EQ(dmd.at("rows"), 768);
  EXPECT_EQ(dmd.at("pitch_m"), 13.68e-6);
  EXPECT_EQ(dmd.at("levels"), 2);
  EXPECT_EQ(dmd.at("modulation"), "amplitude");
}

TEST(Commands, InfoListsLights) {
  const Workplace work;
  const std::string table = succeed(work, {"info", "--lights"});
  EXPECT_NE(table.find("HeNe           632.8 nm    narrow  helium-neon laser"), std::string::npos) << table;
  EXPECT_NE(table.find("LED 530          530 nm     35 nm  Thorlabs M530L4"), std::string::npos) << table;
  const auto lights = nlohmann::json::parse(succeed(work, {"info", "--lights", "--json"})).at("lights");
  EXPECT_GE(lights.size(), 12u);
  EXPECT_EQ(lights[0].at("name"), "HeNe");
  EXPECT_EQ(lights[0].at("wavelength_m"), 632.8e-9);
}

TEST(Commands, FlagsOfWavelengthsTakeLightsByName) {
  const Workplace work;
  const auto json = [&](const std::vector<std::string>& arguments) {
    return nlohmann::json::parse(succeed(work, arguments));
  };
  EXPECT_EQ(json({"limits", "--wavelength", "HeNe, dpss 532", "--json"}),
            json({"limits", "--wavelength", "632.8 nm, 532 nm", "--json"}));
  expect_error(work, {"limits", "--wavelength", "HeNi"}, {"--wavelength: expected a length", "did you mean \"HeNe\"?"});
  expect_error(work, {"limits", "--distance", "HeNe"},
               {"--distance: expected a length with its unit, such as \"300 mm\", got \"HeNe\""});
}

TEST(Commands, EstimateProbesTheScene) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const auto cost = nlohmann::json::parse(succeed(work, {"estimate", "scene.toml", "--json"}));
  // A probe with fewer rays than the scene's 48×48 finds the edges of surfaces to one column and one row of its
  // raster, of 23 or more: 2/23 of each count.
  succeed(work, {"run", "scene.toml", "-o", "out"});
  const auto report = nlohmann::json::parse(work.read("out/report.json"));
  for (const auto& stage : report.at("stages")) {
    if (stage.at("stage") != "trace") continue;
    for (const char* name : {"paths", "rays", "shadow_rays", "waves"})
      EXPECT_NEAR(cost.at(name).get<double>() / stage.at(name).get<double>(), 1, 2.0 / 23) << name;
  }
  for (const char* name : {"trace_seconds", "synthesis_seconds", "simulation_seconds"})
    EXPECT_GT(cost.at(name).get<double>(), 0) << name;
  EXPECT_FALSE(cost.contains("why_no_simulation"));
  EXPECT_NE(succeed(work, {"estimate", "scene.toml"}).find("seconds"), std::string::npos);
}

TEST(Commands, EstimateScalesItsProbeToTheWholeRaster) {
  const Workplace work;
  std::string scene = mesh_scene();
  scene.replace(scene.find("columns = 48\nrows = 48"), 22, "columns = 96\nrows = 96");
  work.write("scene.toml", scene);
  succeed(work, {"run", "scene.toml", "-o", "out"});
  const auto cost = nlohmann::json::parse(succeed(work, {"estimate", "scene.toml", "--json"}));
  const auto report = nlohmann::json::parse(work.read("out/report.json"));
  for (const auto& stage : report.at("stages")) {
    if (stage.at("stage") != "trace") continue;
    // 64×64 rays instead of 96×96: hits differ only along the quad's outline, by one row of 64 at two sides: 2/64 each.
    for (const char* name : {"paths", "rays", "shadow_rays", "waves"})
      EXPECT_NEAR(cost.at(name).get<double>() / stage.at(name).get<double>(), 1, 4 * 2.0 / 64) << name;
  }
}

}  // namespace
}  // namespace holotrace::test
