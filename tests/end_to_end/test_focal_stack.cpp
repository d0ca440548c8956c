// Focal stacks by the command line.

#include <gtest/gtest.h>

#include "end_to_end/scenes.h"
#include "holotrace/io/field/light_field_file.h"
#include "holotrace/io/picture/image_file.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

std::string stack_scene(const std::string& keys) {
  return scene_head() + points_object() + "[render]\npaths = 1\n" + keys;
}

TEST(FocalStacks, AreWrittenAsOneFileOrAsASeriesOfPictures) {
  const Workplace work;
  work.write("points.ply", point_file({{{0.0001, 0, -0.04}}}));
  work.write("scene.toml", stack_scene("focal_stack = \"30 mm, 40 mm\"\n"));
  const Outcome outcome = work.run({"render", "scene.toml", "-o", "stack.h5"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.out.find("focal stack of 2 planes of 256 x 192 pixels: traced in "), 0u) << outcome.out;
  const FocalStack stack = load_focal_stack(work.path("stack.h5"));
  EXPECT_EQ(stack.distances, (std::vector<double>{0.03, 0.04}));
  ASSERT_EQ(work.run({"render", "scene.toml", "-o", "s.exr"}).exit_code, 0);
  for (const size_t k : {0, 1}) {
    const Image image = load_image(work.path(k == 0 ? "s.exr" : "s_2.exr"));
    EXPECT_EQ(image.values, stack.pictures[k].values) << "EXR holds floats";
  }
  // The flag replaces the scene's list. Of the two pictures of a shorter list, none is left over.
  ASSERT_EQ(work.run({"render", "scene.toml", "-o", "s.exr", "--focal-stack", "35 mm"}).exit_code, 0);
  EXPECT_FALSE(work.has("s_2.exr"));
  EXPECT_NE(work.run({"info", "stack.h5"}).out.find("focal stack"), std::string::npos);
  EXPECT_EQ(work.run({"-q", "render", "scene.toml", "-o", "p.png"}).out, "");
  EXPECT_TRUE(work.has("p_2.png"));
}

TEST(FocalStacks, AreRefusedWithASentence) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.04}}}));
  work.write("scene.toml", stack_scene(""));
  const auto error = [&](const std::vector<std::string>& flags) {
    std::vector<std::string> arguments{"render", "scene.toml"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    const Outcome outcome = work.run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    return outcome.err;
  };
  EXPECT_NE(
      error({"-o", "x.h5", "--focal-stack", "30, 0 mm"})
          .find("expected planes of a focal stack behind the panel or in front of it, got one on the panel, at 0 m"),
      std::string::npos);
  EXPECT_NE(error({"-o", "x.h5", "--focal-stack", "30 mm", "--eye-separation", "6 mm"})
                .find("expected one of focal_stack and eye_separation, got both; leave one out"),
            std::string::npos);
  EXPECT_NE(error({"-o", "x.h5"}).find("expected --focal-stack for a picture in .h5"), std::string::npos);
  EXPECT_NE(error({"-o", "x.npy", "--focal-stack", "30 mm"}).find(".h5"), std::string::npos);
}

TEST(FocalStacks, BecomeFramesInColour) {
  const Workplace work;
  work.write("points.ply", point_file({{{0.0001, 0, -0.04}}}));
  work.write("scene.toml", stack_scene(""));
  ASSERT_EQ(work.run({"render", "scene.toml", "-o", "stack.h5", "--focal-stack", "30 mm, 40 mm"}).exit_code, 0);
  const Outcome outcome = work.run({"encode", "stack.h5", "--slm", "scene.toml", "--method", "sgd", "--wavelength",
                                    "520 nm, 450 nm", "--frames", "2", "--iterations", "3", "-o", "h.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* name : {"h.png", "h_2.png", "h_3.png", "h_4.png"}) EXPECT_TRUE(work.has(name)) << name;
  const auto error = [&](std::vector<std::string> flags) {
    std::vector<std::string> arguments{"encode", "stack.h5", "-o", "x.png"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    return work.run(arguments).err;
  };
  EXPECT_NE(error({"--method", "sgd", "--slm", "scene.toml"}).find("has no wavelength; give --wavelength"),
            std::string::npos);
  EXPECT_NE(error({"--wavelength", "520 nm", "--slm", "scene.toml", "--method", "phase"})
                .find("expected --method sgd for the focal stack"),
            std::string::npos);
  EXPECT_NE(error({"--wavelength", "520 nm", "--method", "sgd"}).find("expected a focal stack of 1920 × 1080 pixels"),
            std::string::npos);
}

TEST(FocalStacks, AreTheTargetsOfARun) {
  const Workplace work;
  work.write("points.ply", point_file({{{0.0001, 0, -0.04}}}));
  work.write("scene.toml", stack_scene("[encode]\nmethod = \"sgd\"\ntarget = \"render\"\niterations = 4\n[camera]\n"
                                       "distances = \"40 mm\"\n"));
  const Outcome outcome = work.run({"run", "scene.toml", "-o", "out", "--frames", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* name : {"out/hologram.png", "out/hologram_2.png", "out/view.png", "out/render.png", "out/render.exr",
                           "out/points.ply", "out/convergence.png", "out/report.json"})
    EXPECT_TRUE(work.has(name)) << name;
  EXPECT_FALSE(work.has("out/sources.ply"));
  EXPECT_FALSE(work.has("out/hologram_3.png"));
}

}  // namespace
}  // namespace holotrace::test
