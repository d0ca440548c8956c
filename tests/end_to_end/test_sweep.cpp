// Series of views at several distances and positions of the eye, and their animations, by the command line.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "end_to_end/scenes.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/run/view_holograms.h"
#include "holotrace/run/viewing.h"
#include "support/gif.h"
#include "support/program.h"
#include "support/temporary.h"

namespace holotrace::test {
namespace {

// Points 26 mm and 34 mm behind the small panel, one on the axis and one beside it.
void make_two_points(const Workplace& work) {
  work.write("points.ply", point_file({{{-0.0003, 0, -0.026}}, {{0.0003, 0, -0.034}}}));
  work.write("scene.toml", scene_head() + points_object() + "[camera]\ndistances = \"30 mm\"\n[render]\nrows = 32\n");
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out"}).exit_code, 0);
}

nlohmann::json stage_of(const Workplace& work, const std::string& report, const std::string& name) {
  const nlohmann::json json = nlohmann::json::parse(work.read(report));
  for (const auto& stage : json.at("stages"))
    if (stage.at("stage") == name) return stage;
  ADD_FAILURE() << "no stage " << name;
  return {};
}

// Position between two columns of the light of a small disc near the axis: the centre of the ten brightest pixels.
double place_between(const Image& image, int first, int last) {
  constexpr int width = 10;
  double most = -1;
  int at = first;
  for (int i = first; i + width <= last; ++i) {
    double sum = 0;
    for (int j = image.ny / 2 - 8; j < image.ny / 2 + 8; ++j)
      for (int k = i; k < i + width; ++k) sum += double(image(j, k));
    if (sum > most) at = i;
    most = std::max(most, sum);
  }
  return small_panel.x(at + (width - 1) / 2.0);
}

// Each of the two points is sharpest when the camera is focused on it.
TEST(Sweep, AFocusSweepIsSharpestWhereThePointsAre) {
  const Workplace work;
  make_two_points(work);
  const Outcome outcome =
      work.run({"show", "out/hologram.png", "-o", "view.png", "--distance", "30 mm", "--sweep", "focus", "--sweep-from",
                "22 mm", "--sweep-to", "38 mm", "--sweep-views", "9", "--report", "show.json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto sweep = stage_of(work, "show.json", "sweep");
  const auto sharpness = sweep.at("sharpness").get<std::vector<double>>();
  const auto position = sweep.at("position_m").get<std::vector<double>>();
  ASSERT_EQ(sharpness.size(), 9u);
  for (size_t i = 0; i < 9; ++i) EXPECT_NEAR(position[i], 0.022 + 0.002 * double(i), 1e-12);
  for (const size_t focused : {size_t(2), size_t(6)}) {  // 26 and 34 mm
    EXPECT_GT(sharpness[focused], 2 * sharpness[focused - 1]);
    EXPECT_GT(sharpness[focused], 2 * sharpness[focused + 1]);
  }
  EXPECT_TRUE(work.has("view.png"));
  EXPECT_TRUE(work.has("view_sweep_01.png"));
  EXPECT_TRUE(work.has("view_sweep_09.png"));
  EXPECT_FALSE(work.has("view_sweep_10.png"));
  EXPECT_EQ(load_gif(work.path("view_sweep.gif")).frames.size(), 16u);  // forward and back
}

// A later call with fewer views removes those of an earlier one; holograms stay, whatever their names.
TEST(Show, RemovesViewsOfAnEarlierCallAndNoHologram) {
  const Workplace work;
  make_two_points(work);
  for (const char* name : {"view_4.png", "view_sweep_03.png"}) work.write(name, work.read("out/hologram.png"));
  const std::vector<std::string> one{"show", "out/hologram.png", "-o", "view.png", "--distance", "30 mm"};
  std::vector<std::string> several = one, sweep = one;
  several.back() = "26 mm, 30 mm, 34 mm";
  ASSERT_EQ(work.run(several).exit_code, 0);
  EXPECT_TRUE(work.has("view_3.png"));
  for (const char* word : {"--sweep", "focus", "--sweep-from", "26 mm", "--sweep-to", "34 mm", "--sweep-views", "2"})
    sweep.emplace_back(word);
  ASSERT_EQ(work.run(sweep).exit_code, 0);
  EXPECT_FALSE(work.has("view_2.png") || work.has("view_3.png"));
  EXPECT_TRUE(work.has("view_sweep_01.png") && work.has("view_sweep.gif"));
  ASSERT_EQ(work.run(one).exit_code, 0);
  for (const char* gone : {"view_sweep_01.png", "view_sweep_02.png", "view_sweep.gif", "view_sweep.png"})
    EXPECT_FALSE(work.has(gone)) << gone;
  for (const char* there : {"view.png", "view_4.png", "view_sweep_03.png"}) EXPECT_TRUE(work.has(there)) << there;
}

TEST(Show, ASweepOfFewerViewsLeavesNoneOfAnEarlierOne) {
  const Workplace work;
  make_two_points(work);
  const auto sweep_of = [&](const char* views) {
    const Outcome outcome = work.run({"show", "out/hologram.png", "-o", "view.png", "--distance", "30 mm", "--sweep",
                                      "focus", "--sweep-from", "26 mm", "--sweep-to", "34 mm", "--sweep-views", views});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  sweep_of("4");
  EXPECT_TRUE(work.has("view_sweep_04.png"));
  sweep_of("2");
  EXPECT_TRUE(work.has("view_sweep_02.png"));
  EXPECT_FALSE(work.has("view_sweep_03.png") || work.has("view_sweep_04.png"));
}

// The same for `run`, which also numbers the series by views.
TEST(Run, ASweepOfFewerViewsLeavesNoneOfAnEarlierOne) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.03}}}));
  const auto sweep_of = [&](const std::string& views) {
    work.write("scene.toml", scene_head() + points_object() +
                                 "[camera]\ndistances = \"30 mm\"\nsweep = \"focus\"\nsweep_from = \"26 mm\"\n"
                                 "sweep_to = \"34 mm\"\nsweep_views = " +
                                 views + "\n[render]\nrows = 32\n");
    const Outcome outcome = work.run({"run", "scene.toml", "-o", "out"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  sweep_of("3");
  EXPECT_TRUE(work.has("out/view_sweep_03.png"));
  sweep_of("2");
  EXPECT_TRUE(work.has("out/view_sweep_02.png"));
  EXPECT_FALSE(work.has("out/view_sweep_03.png"));
}

TEST(Show, RefusesToWriteOverItsHologramsAndMoreThanFitsInMemory) {
  const Workplace work;
  make_two_points(work);
  const auto sentence = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"show", "out/hologram.png"});
    const Outcome outcome = work.run(more);
    EXPECT_EQ(outcome.exit_code, 1);
    return outcome.err;
  };
  const std::string before = work.read("out/hologram.png");
  EXPECT_NE(sentence({"-o", "out/../out/hologram.png"}).find("other than the input"), std::string::npos);
  work.write("view_2.png", before);
  EXPECT_EQ(work.run({"show", "view_2.png", "-o", "view.png", "--distance", "26 mm, 30 mm", "--wavelength", "532 nm"})
                .exit_code,
            1);
  EXPECT_EQ(work.read("view_2.png"), before);
  EXPECT_EQ(work.read("out/hologram.png"), before);
  // 1e4 views of 1.6e7 pixels of 12 bytes: 1.9 TB.
  EXPECT_NE(sentence({"-o", "view.png", "--sweep", "focus", "--sweep-from", "26 mm", "--sweep-to", "34 mm",
                      "--sweep-views", "10000", "--width", "2 mm", "--height", "2 mm", "--pixel", "0.5 um"})
                .find("to fit in memory"),
            std::string::npos);
}

TEST(Sweep, ASweepIsInOneExposureAndDoesNotChangeTheView) {
  const Workplace work;
  make_two_points(work);
  const std::vector<std::string> show{
      "show",  "out/hologram.png", "--distance", "30 mm",         "--sweep", "focus", "--sweep-from",
      "26 mm", "--sweep-to",       "30 mm",      "--sweep-views", "2"};
  auto with = [&](const std::string& output) {
    std::vector<std::string> arguments = show;
    arguments.insert(arguments.end(), {"-o", output});
    EXPECT_EQ(work.run(arguments).exit_code, 0);
  };
  with("view.png");
  with("view.exr");
  EXPECT_TRUE(load_image(work.path("view.png")).values == load_image(work.path("out/view.png")).values);
  // A PNG shows value/white. At any pixel both pictures have the same white, to half a code of 255 in each: of sRGB's s,
  // 2.4·(0.5/255)/(s + 0.055) of the light, which is 0.6 % in the middle and 2 % at 0.027 of the white. In focus, a point is
  // that much brighter than out of focus.
  double white[2] = {0, 0}, rounding = 0;
  for (const int i : {0, 1}) {
    const std::string name = "view_sweep_0" + std::to_string(i + 1);
    const Image linear = load_image(work.path(name + ".exr")), shown = load_image(work.path(name + ".png"));
    size_t middle = 0;
    for (size_t k = 0; k < shown.values.size(); ++k)
      if (std::abs(shown.values[k] - 0.5F) < std::abs(shown.values[middle] - 0.5F)) middle = k;
    const double value = double(shown.values[middle]);
    ASSERT_GT(value, 0.02);
    rounding += 2.4 * (0.5 / 255) / (1.055 * std::pow(value, 1 / 2.4));
    white[i] = double(linear.values[middle]) / double(shown.values[middle]);
  }
  EXPECT_NEAR(white[0] / white[1], 1, rounding);
}

TEST(Sweep, AnAnimatedFileIsTheSweepAlone) {
  const Workplace work;
  make_two_points(work);
  const Outcome outcome =
      work.run({"show", "out/hologram.png", "-o", "view.gif", "--distance", "30 mm", "--pupil", "0.6 mm", "--sweep",
                "parallax", "--sweep-from", "-0.5 mm", "--sweep-to", "0.5 mm", "--sweep-views", "3"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(load_gif(work.path("view.gif")).frames.size(), 4u);
  EXPECT_FALSE(work.has("view.png"));
  EXPECT_FALSE(work.has("view_sweep_01.png"));
}

// With focus at 30 mm, a point of depth d is seen at x + (e − x)·(d − 30 mm)/d, with e the eye's position on the panel.
// Each point is in its own half of the picture: the one at 26 mm moves against the eye, the one at 34 mm with it.
TEST(Sweep, PointsBeforeAndBehindTheFocusMoveAgainstEachOther) {
  const Workplace work;
  make_two_points(work);
  const Outcome outcome =
      work.run({"show", "out/hologram.png", "-o", "view.exr", "--distance", "30 mm", "--pupil", "0.5 mm", "--sweep",
                "parallax", "--sweep-from", "-0.4 mm", "--sweep-to", "0.4 mm", "--sweep-views", "2"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  double x[2][2];
  for (const int view : {0, 1}) {
    const Image image = load_image(work.path("view_sweep_0" + std::to_string(view + 1) + ".exr"));
    for (const int half : {0, 1}) x[half][view] = place_between(image, half * image.nx / 2, (half + 1) * image.nx / 2);
  }
  const double near = 0.8e-3 * (0.026 - 0.03) / 0.026, far = 0.8e-3 * (0.034 - 0.03) / 0.034;
  // Discs of 0.5 mm·4/26 = 10 pixels and of 7, whose rings may make either side brighter: 1.5 pixels at
  // each end.
  EXPECT_NEAR(x[0][1] - x[0][0], near, 3 * small_panel.pitch);
  EXPECT_NEAR(x[1][1] - x[1][0], far, 3 * small_panel.pitch);
}

TEST(Sweep, RunWritesItBesideItsViewsAndClearsAnEarlierOne) {
  const Workplace work;
  make_two_points(work);
  const auto run = [&](const std::vector<std::string>& flags) {
    std::vector<std::string> arguments{"run", "scene.toml", "-o", "out"};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    const Outcome outcome = work.run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  run({"--sweep", "focus", "--sweep-from", "26 mm", "--sweep-to", "34 mm", "--sweep-views", "3"});
  EXPECT_TRUE(work.has("out/view_sweep_03.png"));
  EXPECT_TRUE(work.has("out/view_sweep.gif"));
  EXPECT_EQ(stage_of(work, "out/report.json", "sweep").at("sharpness").size(), 3u);
  run({"--sweep", "focus", "--sweep-from", "26 mm", "--sweep-to", "34 mm", "--sweep-views", "2"});
  EXPECT_TRUE(work.has("out/view_sweep_02.png"));
  EXPECT_FALSE(work.has("out/view_sweep_03.png"));
  run({});
  for (const char* name : {"out/view_sweep_01.png", "out/view_sweep.gif", "out/view_sweep.png"})
    EXPECT_FALSE(work.has(name)) << name;
}

TEST(Sweep, ImpossibleSweepsAreRefused) {
  CameraParams camera;
  const auto sentence = [&] { return error_of([&] { viewpoints(camera); }); };
  camera.sweep = Sweep::focus;
  EXPECT_EQ(sentence(),
            "expected a sweep between two places that differ, got 0 m and 0 m; give sweep_from and sweep_to "
            "(--sweep-from, --sweep-to)");
  camera.sweep_from = -1e-3;
  camera.sweep_to = 30e-3;
  EXPECT_EQ(sentence(), "expected a sweep of the focus through distances of 0 m or more, got -1 mm to 30 mm");
  camera.sweep = Sweep::parallax;
  EXPECT_EQ(sentence(),
            "expected a pupil above 0 m for a sweep of parallax, got 0 m, which takes all light wherever the eye is; "
            "give a pupil");
  camera.sweep_views = 1;
  EXPECT_EQ(sentence(), "expected a whole number from 2 to 10000 for \"sweep_views\", got 1");
  camera.sweep_views = 2;
  camera.sweep_seconds = 0;
  EXPECT_EQ(sentence(), "expected a number above 0, up to 3600 for \"sweep_seconds\", got 0");
  camera = {};
  camera.distances = {};
  EXPECT_EQ(sentence(), "expected at least one camera distance, got none");
}

std::vector<std::string> sweep_flags(const char* views = "3") {
  return {"--distance", "30 mm",      "--sweep", "focus",         "--sweep-from",
          "26 mm",      "--sweep-to", "34 mm",   "--sweep-views", views};
}

Outcome show_sweep(const Workplace& work, const std::string& output, const std::vector<std::string>& flags) {
  std::vector<std::string> arguments{"show", "out/hologram.png", "-o", output};
  arguments.insert(arguments.end(), flags.begin(), flags.end());
  return work.run(arguments);
}

TEST(Sweep, ItsPicturesAloneAreASeriesThatALaterCallReplaces) {
  const Workplace work;
  make_two_points(work);
  work.write("v_0002.png", "mine");
  const Outcome outcome = show_sweep(work, "v_####.png", sweep_flags());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err,
            "warning: v_0002.png was not written by an earlier call of this command; it is kept as v_0002.png~\n");
  ASSERT_EQ(show_sweep(work, "beside.png", sweep_flags()).exit_code, 0);
  for (int i = 1; i <= 3; ++i)  // as beside a view
    EXPECT_EQ(load_image(work.path(fmt::format("v_000{}.png", i))).values,
              load_image(work.path(fmt::format("beside_sweep_0{}.png", i))).values);
  const Outcome fewer = show_sweep(work, "v_####.png", sweep_flags("2"));
  ASSERT_EQ(fewer.exit_code, 0) << fewer.err;
  std::set<std::string> names;
  for (const std::string& name : work.names())
    if (name.starts_with("v_")) names.insert(name);
  EXPECT_EQ(names, (std::set<std::string>{"v_0001.png", "v_0002.png", "v_0002.png~"}));
  ASSERT_EQ(show_sweep(work, "j_##.jpg", sweep_flags()).exit_code, 0);
  EXPECT_TRUE(work.has("j_01.jpg") && work.has("j_03.jpg"));
}

// RIFF, a size, WEBP; tests/python/test_pictures_out.py reads what is in it.
TEST(Sweep, ItsAnimationHasTheFormatThatTheCameraNames) {
  const Workplace work;
  make_two_points(work);
  std::vector<std::string> flags = sweep_flags();
  flags.insert(flags.end(), {"--sweep-format", "webp"});
  ASSERT_EQ(show_sweep(work, "v.png", flags).exit_code, 0);
  EXPECT_EQ(work.read("v_sweep.webp").substr(8, 4), "WEBP");
  EXPECT_FALSE(work.has("v_sweep.gif"));
  ASSERT_EQ(show_sweep(work, "alone.webp", sweep_flags()).exit_code, 0);
  EXPECT_TRUE(work.read("alone.webp") == work.read("v_sweep.webp"));
  std::vector<std::string> arguments{"run", "scene.toml", "-o", "out"};
  arguments.insert(arguments.end(), flags.begin(), flags.end());
  const Outcome run = work.run(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(work.has("out/view_sweep.webp") && work.has("out/view_sweep_03.png"));
  EXPECT_FALSE(work.has("out/view_sweep.gif"));
}

TEST(Show, ViewsMayBeJpegs) {
  const Workplace work;
  make_two_points(work);
  const auto views_at = [&](const char* distances) {
    const Outcome outcome = work.run({"show", "out/hologram.png", "-o", "v.jpg", "--distance", distances});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  views_at("26 mm, 34 mm");
  EXPECT_TRUE(work.has("v_2.jpg"));
  EXPECT_EQ(load_image(work.path("v.jpg")).nx, small_panel.nx);
  views_at("26 mm");
  EXPECT_FALSE(work.has("v_2.jpg"));  // it was recorded
  EXPECT_EQ(work.run({"show", "out/hologram.png", "-o", "v.jpg", "--bits", "16"}).err,
            "holotrace: expected 8 bits for the JPEG v.jpg, got 16; name a .png\n");
  EXPECT_EQ(
      work.run({"show", "out/hologram.png", "-o", "v.avi"}).err,
      "holotrace: expected an output file .png or .jpg or .jpeg or .exr or .gif or .webp or .mp4 or .webm, got v.avi; "
      "change its extension\n");
  EXPECT_EQ(
      work.run({"encode", "out/field.npy", "-o", "h.jpg"}).err,
      "holotrace: expected a hologram file .png, .bmp, .tif, .npy or .csv, got h.jpg, and a JPEG would change the levels of its pixels; change "
      "its extension\n");
  const Outcome render = work.run({"render", "scene.toml", "-o", "r.jpeg"});
  EXPECT_EQ(render.exit_code, 0) << render.err;
  EXPECT_EQ(load_image(work.path("r.jpeg")).ny, 32);
}

TEST(Sweep, ASeriesNeedsASweep) {
  const Workplace work;
  EXPECT_EQ(work.run({"show", "hologram.png", "-o", "v_##.png"}).err,
            "holotrace: expected a sweep for the series v_##.png, got none; give --sweep focus or parallax, or a name "
            "without ##\n");
}

TEST(Sweep, AnAnimatedFileNeedsASweep) {
  const Workplace work;  // refused before the hologram is read
  const Outcome outcome = work.run({"show", "hologram.png", "-o", "view.gif"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err,
            "holotrace: expected a sweep for the animated file view.gif, got none; give --sweep focus or parallax, or "
            "name a .png\n");
}

}  // namespace
}  // namespace holotrace::test
