// A viewer's two eyes, looking at a scene and at its hologram.

#include <gtest/gtest.h>

#include <cmath>

#include "end_to_end/scenes.h"
#include "holotrace/io/picture/image_file.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// A point 40 mm behind the panel, seen with focus at 30 mm by eyes 0.8 mm apart. The left eye sees it farther right
// than the right eye, by 0.8 mm·(30 − 40)/40 = −0.2 mm.
std::string stereo_scene() {
  return scene_head() + points_object() +
         "[camera]\ndistances = \"30 mm\"\npupil = \"0.6 mm\"\n"
         "[render]\nrows = 192\ncolumns = 256\nfield_of_view = \"1.4665 deg\"\nfocus = \"30 mm\"\n"
         "eye_separation = \"0.8 mm\"\n";
}

constexpr double disparity = -0.2e-3;

double centre_of_light(const Image& image) {
  double sum = 0, moment = 0;
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i) {
      sum += double(image(j, i));
      moment += double(image(j, i)) * (i - (image.nx - 1) / 2.0);
    }
  return moment / sum;
}

double mean(const Image& image, int channel) {
  double sum = 0;
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i) sum += double(image(j, i, channel));
  return sum;
}

TEST(Stereo, ThePairOfARenderShowsDisparityBySimilarTriangles) {
  const Workplace work;
  for (const double depth : {0.04, 0.03, 0.025}) {
    work.write("points.ply", point_file({{{0.0001, 0, -depth}}}));
    work.write("scene.toml", stereo_scene());
    ASSERT_EQ(work.run({"render", "scene.toml", "-o", "x.exr"}).exit_code, 0);
    const double pixel = 2 * std::tan(1.4665 * 3.141592653589793 / 180) / 192 * 0.03;
    const double seen =
        (centre_of_light(load_image(work.path("x_left.exr"))) - centre_of_light(load_image(work.path("x_right.exr")))) *
        pixel;
    // The floats of an EXR file divide a point's light among four pixels to 1e-7.
    EXPECT_NEAR(seen, 0.8e-3 * (0.03 - depth) / depth, 1e-5 * pixel) << depth;
  }
  EXPECT_TRUE(work.has("x.exr"));
  EXPECT_EQ(load_image(work.path("x.exr")).channels, 3);
}

TEST(Stereo, TheFlagOverrulesTheSceneAndTheAnaglyphHoldsBothPictures) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.04}}}));
  work.write("scene.toml", stereo_scene());
  ASSERT_EQ(work.run({"render", "scene.toml", "-o", "x.exr", "--eye-separation", "0.4 mm"}).exit_code, 0);
  const Image left = load_image(work.path("x_left.exr")), right = load_image(work.path("x_right.exr")),
              both = load_image(work.path("x.exr"));
  for (size_t i = 0; i < both.values.size(); i += 3) {
    ASSERT_FLOAT_EQ(both.values[i], left.values[i]);  // for grey light the luminance is the light
    ASSERT_EQ(both.values[i + 1], right.values[i + 1]);
    ASSERT_EQ(both.values[i + 2], right.values[i + 2]);
  }
  ASSERT_EQ(work.run({"render", "scene.toml", "-o", "one.png", "--eye-separation", "0 m"}).exit_code, 0);
  EXPECT_TRUE(work.has("one.png"));
  EXPECT_FALSE(work.has("one_left.png"));
}

// In the holographic views the disc of blur is symmetric about the ray through the pupil's centre to half a pixel.
TEST(Stereo, TheHolographicPairShowsTheSameDisparity) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.04}}}));
  work.write("scene.toml", stereo_scene());
  const Outcome outcome = work.run({"run", "scene.toml", "-o", "out", "--eye-separation", "0.8 mm"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto apart = [&](const std::string& name) {
    return centre_of_light(load_image(work.path("out/" + name + "_left.png"))) -
           centre_of_light(load_image(work.path("out/" + name + "_right.png")));
  };
  const double pixel = small_panel.pitch;                        // also of the render: the panel's height at 30 mm
  EXPECT_NEAR(apart("stereo") * pixel, disparity, 0.1 * pixel);  // 8-bit codes
  EXPECT_NEAR(apart("holo") * pixel, disparity, 0.5 * pixel);
  for (const char* name : {"out/stereo_anaglyph.png", "out/holo_anaglyph.png"}) {
    const Image both = load_image(work.path(name));
    ASSERT_EQ(both.channels, 3);
    EXPECT_GT(mean(both, 0), 0);
    EXPECT_EQ(mean(both, 1), mean(both, 2));
  }
  ASSERT_EQ(work.run({"render", "scene.toml", "-o", "y.png"}).exit_code, 0);
  EXPECT_TRUE(work.read("y_left.png") == work.read("out/stereo_left.png"));
}

TEST(Stereo, RunNeedsAPupilForTheHologramsPair) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.04}}}));
  std::string text = stereo_scene();
  text.replace(text.find("pupil = \"0.6 mm\""), 16, "pupil = \"0 mm\"");
  work.write("scene.toml", text);
  const Outcome outcome = work.run({"run", "scene.toml", "-o", "out"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err,
            "holotrace: expected a pupil above 0 m for the holographic stereo pair, got 0 m, which takes all light "
            "wherever the eyes are; give the camera a pupil\n");
  EXPECT_FALSE(work.has("out"));
}

}  // namespace
}  // namespace holotrace::test
