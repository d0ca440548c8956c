#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/base/units.h"
#include "holotrace/data/job.h"
#include "holotrace/io/scene/scene_file.h"
#include "io/scene/scene_text.h"
#include "support/temporary.h"

// Shutters of scene files, and the moments while they are open.

namespace holotrace {
namespace {

using test::error_with;
using test::make_file;

std::string scene_with(const std::string& top, const std::string& position) {
  return top +
         "wavelength = \"532 nm\"\n[[object]]\ntype = \"quad\"\nwidth = \"2 mm\"\nheight = \"2 mm\"\nposition = " +
         position + "\n";
}

const std::string moving = "{ \"0 s\" = \"0 0 -300 mm\", \"1 s\" = \"32 0 -300 mm\" }";

Job opened(const std::string& text, double time, double seconds) {
  const std::string path = make_file("scene.toml", text);
  const auto at = [&](double t) { return load_job(path, Outside::refused, {}, "", t); };
  return open_shutter(at(time), seconds, at);
}

TEST(SceneShutter, ItIsATimeOrAnAngle) {
  const auto shutter = [](const std::string& text) {
    return load_job(make_file("scene.toml", scene_with("shutter = \"" + text + "\"\n", moving))).shutter;
  };
  EXPECT_EQ(shutter("20 ms").seconds_at(25), 0.02);
  EXPECT_NEAR(shutter("180 deg").seconds_at(25), 0.02, 1e-17) << "half of 1/25 s, but for rounding";
  EXPECT_FALSE(shutter("0 s").is_open());
  EXPECT_FALSE(load_job(make_file("scene.toml", scene_with("", moving))).shutter.is_open());
}

TEST(SceneShutter, ItsMomentsAreTheMiddlesOfEqualParts) {
  const Job job = opened(scene_with("", moving), 0.25, 0.5);
  ASSERT_EQ(job.moments.size(), size_t(shutter_moments));
  const double start = job.scene.meshes[0].positions[0].x;
  for (int k = 0; k < shutter_moments; ++k)
    EXPECT_NEAR(job.moments[size_t(k)].scene->meshes[0].positions[0].x - start,
                32e-3 * 0.5 * (k + 0.5) / shutter_moments, 1e-15)
        << "32 mm in a second; rounding of some tens of millimetres";
  EXPECT_EQ(job.time, 0.25);
}

TEST(SceneShutter, MomentsAfterTheLastKeyShareOneScene) {
  const Job job = opened(scene_with("", moving), 0.5, 1);
  ASSERT_EQ(job.moments.size(), size_t(shutter_moments));
  EXPECT_NE(job.moments.front().scene, job.moments.back().scene);
  EXPECT_EQ(job.moments[shutter_moments / 2 + 1].scene, job.moments.back().scene);
}

TEST(SceneShutter, NothingMovesWithoutKeysAndAfterThem) {
  EXPECT_TRUE(opened(scene_with("", "\"0 0 -300 mm\""), 0, 1).moments.empty());
  EXPECT_TRUE(opened(scene_with("", moving), 1, 1).moments.empty());
  EXPECT_TRUE(opened(scene_with("", moving), 0, 0).moments.empty());
}

TEST(SceneShutter, AnEyeMovesWithoutItsScene) {
  const Job job = opened(
      scene_with("", "\"0 0 -300 mm\"") + "[render]\neye = { \"0 s\" = \"0 0 0 mm\", \"1 s\" = \"32 0 0 mm\" }\n", 0,
      1);
  ASSERT_EQ(job.moments.size(), size_t(shutter_moments));
  EXPECT_EQ(job.moments.front().scene, job.moments.back().scene);
  EXPECT_NEAR(job.moments.back().eye_moved.x, 32e-3 * (shutter_moments - 0.5) / shutter_moments, 1e-15);
}

TEST(SceneShutter, BadOnesAreRefused) {
  const auto refused = [](const std::string& value) {
    return error_of([&] { load_job(make_file("scene.toml", scene_with("shutter = " + value + "\n", moving))); });
  };
  EXPECT_TRUE(refused("\"-20 ms\"").ends_with("scene.toml:1:11: expected a shutter of 0 s or more, got \"-20 ms\""));
  EXPECT_TRUE(refused("\"20\"").ends_with(
      "expected a time or an angle with its unit, such as \"20 ms\" or \"180 deg\", got \"20\""));
  EXPECT_TRUE(refused("\"20 mm\"").ends_with("such as \"20 ms\" or \"180 deg\", got \"20 mm\""));
  EXPECT_NE(refused("20").find("expected a time or an angle with its unit"), std::string::npos);
  EXPECT_NE(refused("{ \"0 s\" = \"20 ms\" }").find("shutter"), std::string::npos);
}

}  // namespace
}  // namespace holotrace
