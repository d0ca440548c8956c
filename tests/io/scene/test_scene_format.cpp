#include <gtest/gtest.h>

#include <variant>

#include "holotrace/io/files/file.h"
#include "holotrace/io/scene/scene_file.h"
#include "support/build_paths.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

// Checks that docs/reference/scene_format.md describes what load_job does.
class SceneFormat : public ::testing::Test {
 protected:
  std::string text_ = read_text(std::string(HOLOTRACE_SOURCE_DIR) + "/docs/reference/scene_format.md");
};

TEST_F(SceneFormat, ItsExampleLoads) {
  const std::string fence = "```toml\n";
  const size_t begin = text_.find(fence) + fence.size();
  const std::string example = text_.substr(begin, text_.find("```\n", begin) - begin);
  const Job job = load_job(test::make_file("example.toml", example));
  EXPECT_EQ(job.scene.meshes.size(), 6u);  // two pawns of two parts, the board and the crystal
  ASSERT_EQ(job.scene.lights.size(), 2u);
  const auto& lamp = std::get<RectangleLight>(job.scene.lights[0]);
  EXPECT_LT(cross(lamp.edge_u, lamp.edge_v).y, 0);  // as its comment states
  EXPECT_EQ(job.scene.points.size(), 12u * 20 - 16);
  EXPECT_EQ(job.encode.image, ImageSide::real_image);
}

template <class Params>
std::vector<std::string> undocumented(const std::string& text, const std::string& name) {
  const size_t begin = text.find("### `[" + name + "]`");
  if (begin == std::string::npos) return {"the section [" + name + "]"};
  const std::string section = text.substr(begin, text.find("\n###", begin + 3) - begin);
  std::vector<std::string> missing;
  const auto look = [&](const auto& parameter) {
    if (section.find(fmt::format("`{}`", parameter.name)) == std::string::npos) missing.push_back(parameter.name);
    for (const std::string& name : names_of(parameter.choices))
      if (section.find(name) == std::string::npos) missing.push_back(name);
  };
  Params params;
  describe(look, params);
  return missing;
}

TEST_F(SceneFormat, EveryParameterOfEveryStageIsThere) {
  const std::vector<std::string> none;
  EXPECT_EQ(undocumented<TraceParams>(text_, "trace"), none);
  EXPECT_EQ(undocumented<RenderParams>(text_, "render"), none);
  EXPECT_EQ(undocumented<SynthesizeParams>(text_, "synthesize"), none);
  EXPECT_EQ(undocumented<EncodeParams>(text_, "encode"), none);
  EXPECT_EQ(undocumented<ShowParams>(text_, "show"), none);
  EXPECT_EQ(undocumented<PropagateParams>(text_, "propagate"), none);
  EXPECT_EQ(undocumented<CameraParams>(text_, "camera"), none);
  EXPECT_EQ(undocumented<AnimateParams>(text_, "animate"), none);
  EXPECT_EQ(undocumented<EyeParams>(text_, "eye"), none);
}

}  // namespace
}  // namespace holotrace
