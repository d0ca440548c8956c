// Keys of scene files with their old names.

#include <gtest/gtest.h>

#include "holotrace/data/params/renamed.h"
#include "holotrace/io/scene/scene_file.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

// A scene with these tables after a first line with the wavelength.
std::string scene_with(const std::string& tables) {
  return "wavelength = \"532 nm\"\n" + tables +
         "[[object]]\ntype = \"wireframe_cube\"\nsize = \"5 mm\"\npoints_per_edge = 2\nposition = \"0 0 -300 mm\"\n";
}

using Texts = std::vector<std::string>;

TEST(RenamedKeys, AreReadWithOneWarningEachThatNamesThePlace) {
  const std::string path =
      test::make_file("scene.toml", scene_with("[trace]\nlayers = [\"EL\", \"EDL\"]\nseparate_layers = "
                                               "true\n[render]\nlayers = \"EDL\"\n[show]\nmoments = 5\n"));
  const Job job = load_job(path);
  EXPECT_EQ(job.show.illumination_states, 5);
  EXPECT_EQ(job.trace.path_expressions, (Texts{"EL", "EDL"}));
  EXPECT_TRUE(job.trace.separate_path_groups);
  EXPECT_EQ(job.render.path_expressions, Texts{"EDL"});
  const Texts warnings{
      path + ":8:11: `moments` is now called `illumination_states`; the old name is still read",
      path + ":3:10: `layers` is now called `path_expressions`; the old name is still read",
      path + ":4:19: `separate_layers` is now called `separate_path_groups`; the old name is still read",
      path + ":6:10: `layers` is now called `path_expressions`; the old name is still read"};
  EXPECT_EQ(job.warnings, warnings);
}

TEST(RenamedKeys, ByTheirNewNamesWarnOfNothing) {
  const Job job = load_job(test::make_file("scene.toml", scene_with("[trace]\npath_expressions = \"EDL\"\n"
                                                                    "[show]\nillumination_states = 7\n")));
  EXPECT_EQ(job.show.illumination_states, 7);
  EXPECT_EQ(job.warnings, Texts{});
}

// The key with the new name replaces the value of the key with the old name.
TEST(RenamedKeys, OfAnExtendedSceneAreOverruledByTheirNewNames) {
  test::make_file("base.toml", scene_with("[show]\nmoments = 5\nbandwidth = \"1 nm\"\n"));
  const Job job = load_job(test::make_file("scene.toml", "extends = \"base.toml\"\n[show]\nillumination_states = 9\n"));
  EXPECT_EQ(job.show.illumination_states, 9);
  EXPECT_EQ(job.warnings.size(), 1U);
}

TEST(RenamedKeys, GivenTwiceAreAnError) {
  const std::string path = test::make_file("scene.toml", scene_with("[show]\nmoments = 5\nillumination_states = 9\n"));
  EXPECT_EQ(error_of([&] { load_job(path); }),
            path +
                ":3:11: expected one of `illumination_states` and its old name `moments`, got both; leave out the "
                "old one");
}

// An old name is only valid in its own section: [synthesize] never had one.
TEST(RenamedKeys, AreUnknownInOtherSections) {
  const std::string path = test::make_file("scene.toml", scene_with("[synthesize]\nlayers = \"EDL\"\n"));
  EXPECT_NE(error_of([&] { load_job(path); }).find("unknown key \"layers\""), std::string::npos);
}

TEST(RenamedKeys, TheListHasEachNewNameWithOneOldName) {
  for (const RenamedParameter& one : renamed_parameters) EXPECT_STREQ(name_before(one.now), one.before) << one.section;
  EXPECT_EQ(name_before("moments"), nullptr);
}

}  // namespace
}  // namespace holotrace
