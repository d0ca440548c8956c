#include <filesystem>

#include "holotrace/calibrate/patterns.h"
#include "holotrace/io/calibration/calibration_files.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/panels.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

namespace fs = std::filesystem;

std::string fresh_folder(const std::string& name) {
  const std::string folder = test::temporary(name);
  fs::remove_all(folder);
  return folder;
}

CalibrationPlan make_plan(int level_patterns = 2) {
  return {0.06, make_test_patterns(make_panel(64, 70), test_wavelength, 0.06,
                                   {.measured_levels = 5, .level_patterns = level_patterns, .focus_patterns = 1})};
}

// An error's sentence without the folder.
template <class Call>
std::string sentence_in(const std::string& folder, const Call& call) {
  std::string sentence = error_of(call);
  for (size_t at; (at = sentence.find(folder + "/")) != std::string::npos;) sentence.erase(at, folder.size() + 1);
  return sentence;
}

TEST(PlanFile, KeepsThePatterns) {
  const CalibrationPlan plan = make_plan();
  const std::string folder = fresh_folder("plan");
  save_plan(folder, plan);
  const CalibrationPlan again = load_plan(plan_path(folder));
  EXPECT_EQ(again.distance, plan.distance);
  ASSERT_EQ(again.patterns.size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(again.patterns[i].name, plan.patterns[i].name);
    EXPECT_EQ(again.patterns[i].kind, plan.patterns[i].kind);
    EXPECT_EQ(again.patterns[i].hologram.level.values, plan.patterns[i].hologram.level.values);
    EXPECT_EQ(again.patterns[i].hologram.grid, plan.patterns[i].hologram.grid);
    EXPECT_EQ(again.patterns[i].hologram.wavelength, test_wavelength);
    ASSERT_TRUE(again.patterns[i].hologram.slm);
  }
}

TEST(PlanFile, ANewPlanReplacesThePatternsOfAnEarlierOneAndNothingElse) {
  const std::string folder = fresh_folder("plan");
  save_plan(folder, make_plan(3));
  write_text(folder + "/notes.txt", "mine");
  EXPECT_TRUE(fs::exists(folder + "/05_focus.png"));
  save_plan(folder, make_plan(2));
  EXPECT_FALSE(fs::exists(folder + "/05_focus.png"));
  EXPECT_TRUE(fs::exists(folder + "/04_focus.png"));
  EXPECT_TRUE(fs::exists(folder + "/notes.txt"));
}

TEST(PlanFile, ErrorsNameThePlaceAndWhatToDo) {
  const std::string folder = fresh_folder("plan"), path = plan_path(folder);
  save_plan(folder, make_plan());
  const auto with = [&](const std::string& text) {
    write_text(path, text);
    return sentence_in(folder, [&] { load_plan(path); });
  };
  EXPECT_EQ(with("distance = \"60 mm\"\n"),
            "calibration.toml: expected a plan with a table [[pattern]] per test pattern, got none; write it with "
            "`holotrace calibrate patterns`");
  EXPECT_EQ(with("distance = \"60\"\n").substr(0, 23), "calibration.toml:1:12: ");
  EXPECT_EQ(with("distance = \"60 mm\"\n[[pattern]]\nfile = \"01_spots.png\"\nkind = \"spot\"\n"),
            "calibration.toml:4:8: unknown kind \"spot\"; did you mean \"spots\"?");
  EXPECT_EQ(with("distance = \"60 mm\"\n[[pattern]]\nfile = \"gone.png\"\nkind = \"spots\"\n").substr(0, 22),
            "calibration.toml:3:8: ");
  EXPECT_EQ(with("distance = ").substr(0, 19), "calibration.toml:1:");
}

TEST(PlanFile, PhotographsAreFoundByName) {
  const CalibrationPlan plan = make_plan();
  const std::string folder = fresh_folder("photos");
  fs::create_directories(folder);
  Image image(8, 9, 1);
  for (size_t i = 0; i < image.values.size(); ++i) image.values[i] = float(i) / 100;
  EXPECT_EQ(sentence_in(folder, [&] { load_photographs(folder + "/none", plan); }),
            "expected a folder with the photographs, got none, which is none");
  save_image(folder + "/01_spots.exr", image, 1, 8);
  save_image(folder + "/02_levels.png", image, 1, 8);
  save_image(folder + "/03_levels.png", image, 1, 16);
  const std::string missing = error_of([&] { load_photographs(folder, plan); });
  EXPECT_EQ(missing, "expected a photograph of each pattern in " + folder +
                         ", got none of 04_focus; name it as its pattern, with .png, .tif, .jpg or .exr");
  save_image(folder + "/04_focus.exr", image, 1, 8);
  const std::vector<Image> photographs = load_photographs(folder, plan);
  ASSERT_EQ(photographs.size(), 4u);
  EXPECT_EQ(photographs[0].values, image.values);
  EXPECT_NEAR(photographs[1](4, 4), image(4, 4), 0.005);  // half a step of 8 bits at this brightness
}

}  // namespace
}  // namespace holotrace
