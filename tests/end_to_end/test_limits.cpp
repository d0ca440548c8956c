// holotrace limits, by its command line.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "end_to_end/scenes.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

Outcome ask(const Workplace& work, std::vector<std::string> flags) {
  flags.insert(flags.begin(), "limits");
  return work.run(flags);
}

nlohmann::json json_of(const Workplace& work, std::vector<std::string> flags) {
  flags.push_back("--json");
  const Outcome outcome = ask(work, flags);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return nlohmann::json::parse(outcome.out);
}

TEST(LimitsCommand, TellsOrdersZonesAndWhatAnEyeNeeds) {
  const Workplace work;
  const auto gaea = json_of(work, {"--slm", "gaea", "--wavelength", "633 nm", "--frames", "60", "--colours", "3"});
  EXPECT_NEAR(gaea.at("half_angle_deg").get<double>(), 4.854, 5e-4);  // closed_forms.md, section 1
  ASSERT_EQ(gaea.at("orders").size(), 11U);
  EXPECT_EQ(gaea.at("orders")[6].at("order"), 1);
  EXPECT_NEAR(gaea.at("orders")[6].at("offset_m").get<double>(), gaea.at("order_spacing_m").get<double>(), 1e-15);
  EXPECT_EQ(gaea.at("vision").size(), 5U);
  EXPECT_TRUE(gaea.at("vision")[0].at("is_met").get<bool>());  // resolution, for a panel wider than 2.2 mm
  const auto pluto = json_of(work, {"--wavelength", "532 nm"});
  EXPECT_NEAR(pluto.at("alias_free_distance_m").get<double>(), 0.4617, 5e-5);  // z* of closed_forms.md, section 2
}

TEST(LimitsCommand, TellsPixelsAndBytesPerSecond) {
  const Workplace work;
  const auto value_of = [](const std::string& table, const std::string& row) {
    const size_t at = table.find(row);
    return at == std::string::npos ? -1 : std::stod(table.substr(at + row.size()));
  };
  const double rate = 1920.0 * 1080 * 60;  // pluto and ideal; of 8 bits, and of 16
  for (const auto& [slm, bytes] : {std::pair{"pluto", 1}, {"ideal", 2}}) {
    const Outcome table = ask(work, {"--slm", slm, "--frames", "60"});
    EXPECT_NEAR(value_of(table.out, "pixels per second"), rate, 5e-4 * rate) << slm;  // four digits
    EXPECT_NEAR(value_of(table.out, "bytes per second"), bytes * rate, 5e-4 * bytes * rate) << slm;
  }
}

TEST(LimitsCommand, HasAColumnForEachWavelength) {
  const Workplace work;
  const auto colours = json_of(work, {"--wavelength", "638 nm, 520 nm, 450 nm"});
  ASSERT_EQ(colours.at("wavelengths").size(), 3U);
  EXPECT_EQ(colours.at("half_angle_deg"), colours.at("wavelengths")[0].at("half_angle_deg"));
  EXPECT_GT(colours.at("half_angle_deg"), colours.at("wavelengths")[2].at("half_angle_deg"));
  const Outcome table = ask(work, {"--wavelength", "638 nm, 520 nm, 450 nm"});
  EXPECT_EQ(table.exit_code, 0) << table.err;
  for (const char* words : {"Angles", "half diffraction angle", "638 nm", "450 nm", "order +-1", "resolution", "eyebox",
                            "alias-free distance", "space-bandwidth product", "For an eye", "not met"})
    EXPECT_NE(table.out.find(words), std::string::npos) << words;
  EXPECT_NE(ask(work, {"--wavelength", "16 um"}).out.find("every direction"), std::string::npos);
}

TEST(LimitsCommand, WorksBackwards) {
  const Workplace work;
  const auto wanted = json_of(work, {"--angle", "15 deg", "--size", "100 mm", "--frames", "30", "--colours", "3"});
  EXPECT_NEAR(wanted.at("wanted_pitch_m").get<double>(), 1.181e-6, 5e-10);  // the paper's 1.18 µm
  EXPECT_NEAR(wanted.at("pixels_per_second").get<double>(), 6.45e11, 0.01e11);
  EXPECT_EQ(wanted.at("vision").size(), 5U);
  // By the grating equation: 632.8 nm / (2 sin 15°).
  EXPECT_NEAR(wanted.at("coarsest_pitch_m").get<double>(), 632.8e-9 / (2 * 0.2588190451), 1e-15);
  // Of a given side and one for a resolution the larger counts: 100 mm against 18.98 mm for 10 µm, at the same pitch.
  const auto both = json_of(work, {"--angle", "15 deg", "--size", "100 mm", "--resolution", "10 um"});
  EXPECT_EQ(both.at("wanted_pixels_per_side"), wanted.at("wanted_pixels_per_side"));
  // λz/S: 10 µm at 300 mm and 632.8 nm are 18.98 mm.
  const auto fine = json_of(work, {"--angle", "2 deg", "--resolution", "10 um", "--distance", "300 mm"});
  EXPECT_NEAR(fine.at("wanted_size_m").get<double>(), 18.984e-3, 1e-9);
  EXPECT_EQ(ask(work, {"--angle", "15 deg", "--size", "100 mm"}).out.substr(0, 11), "pixel pitch");
}

TEST(LimitsCommand, DrawsTheSceneInTheAliasFreeVolume) {
  const Workplace work;
  work.write("scene.toml", mesh_scene());
  const auto facts = json_of(work, {"--scene", "scene.toml", "--picture", "volume.svg", "--plot", "angles.svg"});
  EXPECT_EQ(facts.at("pitch_m").get<double>(), 8e-6);
  EXPECT_NEAR(facts.at("wavelength_m").get<double>(), 532e-9, 1e-15);  // the scene's wavelength
  const auto& scene = facts.at("scene");
  EXPECT_GT(scene.at("points").get<int>(), 50);
  EXPECT_EQ(scene.at("lighting_the_whole_panel").get<int>() + scene.at("lighting_a_part").get<int>() +
                scene.at("outside").get<int>(),
            scene.at("points").get<int>());
  for (const char* name : {"volume.svg", "volume_y.svg", "angles.svg"}) {
    ASSERT_TRUE(work.has(name)) << name;
    EXPECT_NE(work.read(name).find("<svg"), std::string::npos) << name;
  }
  EXPECT_NE(work.read("volume.svg").find("points that light it"), std::string::npos);
}

TEST(LimitsCommand, TakesTheMeanDepthOfASceneAsItsDistance) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.03}}, {{0.0004, 0.0002, -0.05}}}));
  work.write("scene.toml", scene_head() + points_object());
  EXPECT_NEAR(json_of(work, {"--scene", "scene.toml"}).at("distance_m").get<double>(), 0.04, 1e-15);
  EXPECT_EQ(json_of(work, {"--scene", "scene.toml", "--distance", "25 mm"}).at("distance_m").get<double>(), 0.025);
}

TEST(LimitsCommand, RefusesWhatItCannotAnswer) {
  const Workplace work;
  const auto sentence = [&](const std::vector<std::string>& flags) {
    const Outcome outcome = ask(work, flags);
    EXPECT_EQ(outcome.exit_code, 1);
    return outcome.err;
  };
  EXPECT_NE(sentence({"--picture", "volume.jpg"}).find(".png"), std::string::npos);
  EXPECT_NE(sentence({"--resolution", "10 um"}).find("--angle"), std::string::npos);
  EXPECT_NE(sentence({"--angle", "15 deg", "--distance", "1 m"}).find("--resolution"), std::string::npos);
  EXPECT_NE(sentence({"--angle", "15 deg", "--picture", "a.png"}).find("--picture"), std::string::npos);
  EXPECT_NE(sentence({"--slm", "plutto"}).find("pluto"), std::string::npos);
  for (const char* size : {"-5 mm", "0 mm"})
    EXPECT_NE(sentence({"--angle", "15 deg", "--size", size}).find("--size: expected a length above 0 m"),
              std::string::npos);
  EXPECT_NE(sentence({"--angle", "15 deg", "--size", "1e30 m"}).find("--size: expected a length of at most 1e+06 m"),
            std::string::npos);
  for (const char* plot : {"w.png", "./w_y.png"})
    EXPECT_NE(sentence({"--picture", "w.png", "--plot", plot}).find("expected a file for each output"),
              std::string::npos)
        << plot;
  EXPECT_FALSE(work.has("w.png"));
}

// λ/P above 1: a grating of 0.4 µm has no order 1 at 532 nm, but has one at 300 nm.
TEST(LimitsCommand, ReportsAnEvanescentOrder) {
  const Workplace work;
  const std::vector<std::string> flags{"--wavelength", "532 nm, 300 nm", "--period", "0.4 um"};
  const std::string table = ask(work, flags).out;
  const size_t row = table.find("grating 400 nm, order 1");
  ASSERT_NE(row, std::string::npos) << table;
  EXPECT_EQ(table.substr(row, table.find('\n', row) - row).find("infinite"), std::string::npos);
  EXPECT_NE(table.substr(row, table.find('\n', row) - row).find("evanescent"), std::string::npos);
  const auto facts = json_of(work, flags);
  EXPECT_TRUE(facts.at("order_offset_m").is_null());
  EXPECT_TRUE(facts.at("wavelengths")[1].at("order_offset_m").is_number());
}

}  // namespace
}  // namespace holotrace::test
