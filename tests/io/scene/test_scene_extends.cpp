// `extends` in a scene file: the tables of one scene replace those of another.

#include "holotrace/io/scene/scene_file.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

constexpr const char* base_scene = R"(wavelength = "632.8 nm"
background = 0.5

[trace]
columns = 16
rows = 8

[camera]
distances = "300 mm"

[[object]]
type = "wireframe_cube"
size = "5 mm"
points_per_edge = 2
position = "0 0 -300 mm"
)";

TEST(SceneExtends, KeysOverruleAndTheOthersStay) {
  test::make_file("base.toml", base_scene);
  const Job job = load_job(test::make_file("scene.toml", R"(extends = "base.toml"
background = 0.25
[trace]
columns = 32
)"));
  EXPECT_EQ(job.trace.columns, 32);
  EXPECT_EQ(job.trace.rows, 8);
  EXPECT_EQ(job.wavelengths.front(), 632.8e-9);
  EXPECT_EQ(job.scene.background.x, 0.25);
  EXPECT_EQ(job.scene.points.size(), 8u);  // the corners of the cube
}

TEST(SceneExtends, AListOfTablesReplacesTheWholeList) {
  test::make_file("base.toml", base_scene);
  const Job job = load_job(test::make_file("scene.toml", R"(extends = "base.toml"
[[object]]
type = "point_quad"
width = "1 mm"
height = "1 mm"
columns = 3
rows = 3
position = "0 0 -200 mm"
)"));
  EXPECT_EQ(job.scene.points.size(), 9u);
}

TEST(SceneExtends, AnErrorNamesTheFileThatHoldsIt) {
  const std::string base = test::make_file("base.toml", base_scene);
  const std::string scene = test::make_file("scene.toml", "extends = \"base.toml\"\n[trace]\ncolumns = 2.5\n");
  EXPECT_EQ(error_of([&] { load_job(scene); }).find(scene + ":3:11: expected"), 0u);

  test::make_file("base.toml", std::string(base_scene) + "colour = 1\n");  // line 16, in [[object]]
  test::make_file("scene.toml", "extends = \"base.toml\"\n");
  EXPECT_EQ(error_of([&] { load_job(scene); }).find(base + ":16:1: "), 0u);
}

TEST(SceneExtends, AMissingFileAndACircleAreRefused) {
  const std::string scene = test::make_file("scene.toml", "extends = \"other.toml\"\n");
  EXPECT_EQ(error_of([&] { load_job(scene); }).find(scene + ":1:11: "), 0u);
  test::make_file("other.toml", "\nextends = \"scene.toml\"\n");
  const std::string error = error_of([&] { load_job(scene); });
  EXPECT_NE(error.find("other.toml:2:11: expected a scene that does not extend itself"), std::string::npos) << error;
}

}  // namespace
}  // namespace holotrace
