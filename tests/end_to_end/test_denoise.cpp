// Which pictures of the program are denoised.

#include <gtest/gtest.h>

#include <filesystem>

#include "end_to_end/scenes.h"
#include "holotrace/io/picture/image_file.h"
#include "support/build_paths.h"
#include "support/denoiser.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// A wall before a lamp, with few light paths.
void write_scene(const Workplace& work) {
  work.write("scene.toml", scene_head() + R"(
[[light]]
type = "rectangle"
corner = "-1 2 -29 mm"
edge_u = "2 0 0 mm"
edge_v = "0 1 1 mm"
radiance = 9
[[object]]
type = "quad"
width = "4 mm"
height = "4 mm"
position = "0 0 -30 mm"
[render]
columns = 64
rows = 48
paths = 2
)");
}

TEST(DenoisedPictures, ArePngFilesAndRadianceIfAllIsAskedFor) {
  HOLOTRACE_NEEDS_DENOISER();
  const Workplace work;
  write_scene(work);
  const auto differ = [&](const std::string& name, const std::string& denoise, const std::string& other) {
    expect_success(work, {"render", "scene.toml", "-o", name, "--denoise", denoise});
    const auto first = load_image(work.path(name)).values;
    expect_success(work, {"render", "scene.toml", "-o", name, "--denoise", other});
    return load_image(work.path(name)).values != first;
  };
  EXPECT_TRUE(differ("a.png", "none", "auto"));
  EXPECT_FALSE(differ("a.png", "auto", "all"));
  EXPECT_FALSE(differ("a.exr", "none", "auto"));
  EXPECT_TRUE(differ("a.exr", "none", "all"));
  expect_success(work, {"render", "scene.toml", "-o", "plain.exr"});
  expect_success(work, {"render", "scene.toml", "-o", "none.exr", "--denoise", "none"});
  EXPECT_EQ(work.read("plain.exr"), work.read("none.exr")) << "auto is the default";
}

// The program of a wheel lies in site-packages/holotrace.scripts. There it finds the package pyoidn beside it: here a fake,
// which fails with a sentence of its own.
TEST(DenoisedPictures, OfAWheelAreDenoisedByThePackageBesideIt) {
  const Workplace work;
  write_scene(work);
  const auto put = [&](const char* file, const std::string& name) {
    std::filesystem::create_directories(std::filesystem::path(work.path(name)).parent_path());
    std::filesystem::copy_file(file, work.path(name));
  };
  put(HOLOTRACE_PROGRAM, "holotrace.scripts/holotrace");
  put(HOLOTRACE_FAKE_OIDN, "pyoidn/oidn/lib/libOpenImageDenoise.so.2");
  const Environment anywhere("HOLOTRACE_OIDN", "");
  const Environment of("FAKE_OIDN_VERSION", "20399");
  const Outcome outcome = work.run_under({"sh", "-c", "shift; exec holotrace.scripts/holotrace \"$@\"", "sh"},
                                         {"render", "scene.toml", "-o", "a.png"});
  EXPECT_NE(outcome.err.find("the filter is a fake"), std::string::npos) << outcome.err;
}

TEST(DenoisedPictures, WithoutTheLibraryAreMadeAsTheyAreAndOneSentenceSaysSo) {
  const Workplace work;
  write_scene(work);
  const Environment nowhere("HOLOTRACE_OIDN", "/nowhere");
  expect_success(work, {"render", "scene.toml", "-o", "none.png", "--denoise", "none"});
  const Outcome outcome = work.run({"render", "scene.toml", "-o", "auto.png"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("pictures are not denoised: expected Open Image Denoise 2 in HOLOTRACE_OIDN, got"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(load_image(work.path("auto.png")).values, load_image(work.path("none.png")).values);
}

}  // namespace
}  // namespace holotrace::test
