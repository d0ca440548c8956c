// Views of holograms in the camera: the loop that `run` and `holotrace show` share.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "end_to_end/scenes.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/scene/scene_file.h"
#include "holotrace/run/illumination_plan.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/run/view_holograms.h"
#include "holotrace/run/viewing.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/expose.h"
#include "support/png.h"
#include "support/program.h"
#include "support/temporary.h"

namespace holotrace::test {
namespace {

std::string scene(const std::string& more = "") {
  return scene_head() + points_object() + "[camera]\ndistances = \"30 mm\"\n[render]\nrows = 32\n" + more;
}

Workplace& with_points(Workplace& work) {
  work.write("points.ply", point_file({{{-0.0003, 0, -0.026}}, {{0.0003, 0.0002, -0.034}}}));
  return work;
}

nlohmann::json stages_of(const std::string& report) {
  nlohmann::json stages;
  const nlohmann::json json = nlohmann::json::parse(report);
  for (const auto& stage : json.at("stages")) stages[stage.at("stage").get<std::string>()] = stage;
  return stages;
}

// The same hologram without its metadata, as another program writes it, with flags in their place.
TEST(Viewing, HologramsOfOtherProgramsAreShownAsTheirFlagsSay) {
  Workplace work;
  with_points(work).write("scene.toml", scene());
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out"}).exit_code, 0);
  work.write("other.png", work.read("out/hologram.png"));
  drop_metadata(work.path("other.png"));
  const auto shown = [&](const std::string& file, std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"show", file, "-o", "view.exr", "--slm", "scene.toml"});
    const Outcome outcome = work.run(flags);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return work.read("view.exr");
  };
  const std::string light = "--wavelength", green = "532 nm", at = "--distance";
  const std::string view = shown("out/hologram.png", {at, "26 mm"});
  EXPECT_EQ(shown("other.png", {light, green, at, "26 mm"}), view);
  // The real image's plane at −26 mm is the virtual one's at 26 mm.
  EXPECT_EQ(shown("other.png", {light, green, at, "-26 mm", "--image", "real"}), view);
  EXPECT_NE(shown("other.png", {light, green, at, "26 mm", "--image", "real"}), view);
  EXPECT_NE(shown("other.png", {light, green, at, "26 mm", "--modulation", "amplitude"}), view);
  EXPECT_NE(shown("other.png", {light, green, at, "26 mm", "--range", "180 deg"}), view);
  EXPECT_EQ(shown("other.png", {light, green, at, "26 mm", "--range", "360 deg", "--levels", "256"}), view);
  const auto refused = [&](const std::vector<std::string>& flags, const std::string& sentence) {
    const Outcome outcome = work.run(flags);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_NE(outcome.err.find(sentence), std::string::npos) << outcome.err;
  };
  refused({"show", "other.png", "-o", "v.png", light, green, "--levels", "5"}, "expected the greys of 5 levels");
  refused({"show", "out/hologram.png", "-o", "v.png", "--levels", "4"},
          "expected --levels, --modulation and --channel only for files without metadata");
  refused({"show", "other.png", "-o", "v.png", light, green, "--image", "left"}, "virtual");
  refused({"show", "other.png", "-o", "v.png"}, "other.png has no metadata; give --wavelength");
}

TEST(Viewing, InfoDescribesHologramsOfOtherProgramsAsTheirFlagsSay) {
  Workplace work;
  with_points(work).write("scene.toml", scene());
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out"}).exit_code, 0);
  work.write("other.png", work.read("out/hologram.png"));
  drop_metadata(work.path("other.png"));
  const auto facts = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"info", "--json"});
    const Outcome outcome = work.run(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(outcome.out);
  };
  EXPECT_EQ(facts({"other.png"})["kind"], "image");
  const nlohmann::json told = facts({"other.png", "--image", "real", "--wavelength", "532 nm", "--pitch", "6 um"});
  EXPECT_EQ(told["kind"], "hologram");
  EXPECT_EQ(told["image"], "real");
  EXPECT_EQ(told["wavelength"], "532 nm");
  EXPECT_EQ(told["pitch"], "6 µm");
  EXPECT_EQ(told["levels"], 256);
  EXPECT_FALSE(facts({"other.png", "--modulation", "amplitude"}).contains("wavelength"));
  const Outcome scene_told = work.run({"info", "scene.toml", "--image", "real"});
  EXPECT_EQ(scene_told.exit_code, 1);
  EXPECT_NE(scene_told.err.find("--image is for holograms, but scene.toml is none; leave out --image"),
            std::string::npos)
      << scene_told.err;
}

TEST(Viewing, IsTheWeightedSumOverIlluminationStates) {
  Workplace work;
  with_points(work).write("scene.toml", scene());
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out"}).exit_code, 0);
  const Hologram hologram = load_hologram(work.path("out/hologram.png"));
  const Slm slm = *hologram.slm;
  ShowParams params;
  params.bandwidth = 5e-9;
  params.source_angle = 1e-3;
  params.illumination_states = 5;
  CameraParams camera;
  camera.distances = {0.026, 0.034};
  const auto from = viewpoints(camera);
  Report report;
  const StageObserver watch;
  RepeatedStages repeat(1, 5, viewing_calls(5, from), report, watch);
  std::vector<CombinedViews> sums(from.size());
  view_hologram(hologram, {slm, params, {}, from}, repeat, sums);

  for (size_t d = 0; d < 2; ++d) {
    std::vector<double> expected;
    double weights = 0;
    for (const IlluminationState& state :
         plan_illumination(slm, params, hologram.wavelength, hologram.image, from).states) {
      const Image view =
          look(show(hologram, slm, params, state), slm, camera.distances[d], {}, camera, {}, state.source);
      expected.resize(view.values.size());
      for (size_t i = 0; i < expected.size(); ++i) expected[i] += state.weight * double(view.values[i]);
      weights += state.weight;
    }
    EXPECT_NEAR(weights, 1, 1e-12);
    const Image seen = sums[d].image();
    const double most = *std::max_element(expected.begin(), expected.end());
    for (size_t i = 0; i < expected.size(); ++i) ASSERT_NEAR(seen.values[i], expected[i], 1e-6 * most);  // floats
  }
  ASSERT_EQ(report.stages.size(), 3u);
  EXPECT_EQ(report.stages[0].stage, "show");
  EXPECT_EQ(report.stages[1].stage, "look at 26 mm");
}

// A source of the angle α blurs an image at d to a disc of the diameter α·d: 10 mrad · 30 mm = 300 µm.
TEST(Viewing, LightOfAWideSourceBlursByItsAngle) {
  Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.03}}}));
  work.write("scene.toml", scene());
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out"}).exit_code, 0);
  const auto show_as = [&](const std::string& name, std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"show", "out/hologram.png", "-o", name, "--distance", "30 mm"});
    EXPECT_EQ(work.run(flags).exit_code, 0);
    return load_image(work.path(name));
  };
  const Image sharp = show_as("sharp.exr", {});
  const Image wide = show_as("wide.exr", {"--source-angle", "0.57296 deg"});
  const auto within = [](const Image& image, double radius) {
    double inside = 0;
    for (int j = 0; j < image.ny; ++j)
      for (int i = 0; i < image.nx; ++i)
        if (std::hypot(small_panel.x(i), small_panel.y(j)) <= radius) inside += double(image(j, i));
    return inside;
  };
  // The disc of 150 µm has the light of the sharp point's few pixels, except what crosses its rim (a speckle of 8 µm
  // around it): within 10 %. Half of it is within 150 µm/√2.
  EXPECT_NEAR(within(wide, 160e-6) / within(sharp, 160e-6), 1, 0.1);
  EXPECT_NEAR(within(wide, 150e-6 / std::sqrt(2.0)) / within(wide, 160e-6), 0.5, 0.1);
  EXPECT_GT(within(sharp, 20e-6) / within(sharp, 160e-6), 0.5);
  // A uniform disc, apart from the 5 % of the point's light that is beyond 100 µm from its centre. Sixteen states would
  // give as many spots.
  double least = 1e300, most = 0;
  for (int j = 0; j < wide.ny; ++j)
    for (int i = 0; i < wide.nx; ++i)
      if (std::hypot(small_panel.x(i), small_panel.y(j)) <= 110e-6) {
        least = std::min(least, double(wide(j, i)));
        most = std::max(most, double(wide(j, i)));
      }
  EXPECT_GT(least, 0.85 * most);
}

// The numbers of docs/explanation/slm.md, by hand: 2 mm of panel, 532 nm, pixels of 8 µm.
TEST(Viewing, AsManyIlluminationStatesAsTheViewsNeed) {
  const Slm slm{.name = "test", .grid = {256, 256, 8e-6}};
  CameraParams camera;
  camera.distances = {0.1};
  const auto plan = [&](const ShowParams& params, const std::optional<SpectralFilter>& filter = {}) {
    return plan_illumination(slm, params, 532e-9, ImageSide::virtual_image, viewpoints(camera), filter);
  };
  EXPECT_EQ(plan({}).states.size(), 1U);
  EXPECT_TRUE(plan({}).why.empty());
  // The displayed orders span 66.5 mrad: 5 mrad move by 0.075 of it, and π/4·(8·0.075)² = 0.28.
  EXPECT_EQ(plan({.source_angle = 5e-3}).states.size(), 1U);
  EXPECT_EQ(plan({.source_angle = 5e-3}).states[0].source.angle, 5e-3);
  // A stop of 10 mrad: π/4·(8·0.5)² = 12.6.
  const double half = 5e-3 / 532e-9;
  EXPECT_EQ(plan({.source_angle = 5e-3}, SpectralFilter{0, 0, half, 1e9}).states.size(), 13U);
  // 10 nm and f = min(62500, 38496)/m: 2·38496·0.1·10e-9 m = 77 µm, in steps of λz/S = 26 µm: 3, but 8 are the fewest;
  // at 20 mm f = 62500/m: 25 µm in steps of a pixel.
  EXPECT_EQ(plan({.bandwidth = 10e-9}).states.size(), 8U);
  EXPECT_EQ(plan({.bandwidth = 100e-9}).states.size(), 30U);  // 770/26.0 = 29.7
  // At 20 mm three samples per pixel hold the 187 500/m of their band: 2·187500·20e-3·60e-9 m = 450 µm. A sensor pixel
  // is a panel pixel of 8 µm by default, and a sample of 8/3 µm with a binning of 1, where λz/S = 5.2 µm is coarser.
  camera.distances = {0.02};
  EXPECT_EQ(plan({.subpixels = 3, .bandwidth = 60e-9}).states.size(), 57U);  // 450/8 = 56.25
  camera.binning = 1;
  EXPECT_EQ(plan({.subpixels = 3, .bandwidth = 60e-9}).states.size(), 87U);  // 450/5.195 = 86.6
  camera.binning = 3;
  EXPECT_EQ(plan({.subpixels = 3, .bandwidth = 60e-9}).states.size(), 57U);
  camera.binning = 0;
  camera.distances = {0.1};
  // One illumination state per wavelength represents the whole source where possible.
  EXPECT_EQ(plan({.bandwidth = 10e-9, .source_angle = 5e-3}).states[3].source.angle, 5e-3);
  EXPECT_EQ(plan({.bandwidth = 10e-9, .source_angle = 5e-3}).states[3].tilt_x, 0);
  // An eye at 200 mm with a pupil of 2 mm: the source moves its light by 1 mm of 2: 12.6 again.
  camera.pupil = 2e-3;
  camera.eye.z = 0.2;
  EXPECT_EQ(plan({.source_angle = 10e-3}).states.size(), 51U);  // π/4·64·1
  EXPECT_EQ(plan({.source_angle = 5e-3}).states.size(), 13U);
  EXPECT_EQ(plan({.source_angle = 50e-3}).states.size(), 256U);
  EXPECT_EQ(
      doubt_of(plan({.source_angle = 50e-3}), {.source_angle = 50e-3}),  // π/4·64·25 = 1256.6
      "this light needs 1257 illumination states, the limit is 256: the view will look grainy; use a smaller source, or set "
      "illumination_states to 1257");
  EXPECT_EQ(
      doubt_of(plan({.source_angle = 5e-3, .illumination_states = 1}),
               {.source_angle = 5e-3, .illumination_states = 1}),
      "this light needs 13 illumination states, 1 is given: the view will look grainy; set illumination_states to 13, or to 0 for as many "
      "as the view needs");
  EXPECT_EQ(doubt_of(plan({.source_angle = 5e-3}), {.source_angle = 5e-3}), "");
  // Numbers of states and samples that exceed any memory are refused by their ranges.
  const std::string many = error_of([&] { plan({.illumination_states = 65537}); });
  EXPECT_NE(many.find("65536"), std::string::npos) << many;
  const std::string fine = error_of([&] { plan({.subpixels = 65537}); });
  EXPECT_NE(fine.find("1 to 65536"), std::string::npos) << fine;
  EXPECT_EQ(plan({.subpixels = 64, .source_angle = 5e-3, .illumination_states = 65}).states.size(), 65U);
}

// 40e6 pixels per side with 64 samples each: 2.56e9 exceeds an int.
TEST(Viewing, SamplesBeyondAnIntAreRefused) {
  const Slm slm{.name = "test", .grid = {40000000, 4, 8e-6}};
  EXPECT_EQ(
      error_of([&] {
        viewing_need({slm, {.subpixels = 64}, {}, viewpoints(CameraParams{})}, {532e-9}, ImageSide::virtual_image);
      }),
      "expected at most 2147483647 samples a side, got 2560000000 × 256; use fewer subpixels");
}

TEST(Viewing, TooFewIlluminationStatesAreTold) {
  Workplace work;
  with_points(work).write("scene.toml", scene());
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out"}).exit_code, 0);
  const auto warnings_of = [&](const std::string& states) {
    const Outcome outcome = work.run({"show", "out/hologram.png", "-o", "view.png", "--distance", "30 mm",
                                      "--bandwidth", "4 nm", "--illumination-states", states, "--report", "show.json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return stages_of(work.read("show.json")).at("show").value("warnings", nlohmann::json::array());
  };
  ASSERT_EQ(warnings_of("3").size(), 1U);
  EXPECT_EQ(
      warnings_of("3")[0].get<std::string>(),
      "this light needs 8 illumination states, 3 are given: the view will look grainy; set illumination_states to 8, or to 0 for as many "
      "as the view needs");
  EXPECT_TRUE(warnings_of("8").empty());
}

TEST(Viewing, ShowSeesWhatRunSaw) {
  Workplace work;
  with_points(work).write("scene.toml",
                          scene("[show]\nbandwidth = \"4 nm\"\nillumination_states = 3\nsubpixels = 3\n") + "");
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out", "--electrons", "200", "--read-noise", "3"}).exit_code, 0);
  const Outcome outcome = work.run({"show", "out/hologram.png", "-o", "view.png", "--distance", "30 mm", "--bandwidth",
                                    "4 nm", "--illumination-states", "3", "--subpixels", "3", "--electrons", "200",
                                    "--read-noise", "3", "--report", "show.json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(work.read("view.png") == work.read("out/view.png"));
  const auto of_run = stages_of(work.read("out/report.json")), of_show = stages_of(work.read("show.json"));
  EXPECT_EQ(of_run.at("show").at("power_out"), of_show.at("show").at("power_out"));
  EXPECT_EQ(of_show.at("show").at("illumination_states"), 3);
  EXPECT_TRUE(of_show.contains("look at 30 mm"));
}

TEST(Viewing, ShowSeesAJointHologramInAllOfItsColours) {
  Workplace work;
  with_points(work).write("scene.toml",
                          "wavelength = [\"632.8 nm\", \"520 nm\"]\n" +
                              scene("[encode]\nmethod = \"sgd\"\n"
                                    "target = \"render\"\njoint = true\niterations = 6\ntarget_distances = \"30 mm\"\n")
                                  .substr(scene_head().find('[')));
  const Outcome of_run = work.run({"run", "scene.toml", "-o", "out", "--frames", "1"});
  ASSERT_EQ(of_run.exit_code, 0) << of_run.err;
  ASSERT_FALSE(work.has("out/hologram_2.png"));
  const Outcome outcome = work.run({"show", "out/hologram.png", "-o", "view.png", "--distance", "30 mm"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(work.read("view.png") == work.read("out/view.png"));
  // One colour is shown when it is asked for.
  ASSERT_EQ(work.run({"show", "out/hologram.png", "-o", "green.png", "--distance", "30 mm", "--wavelength", "520 nm"})
                .exit_code,
            0);
  EXPECT_FALSE(work.read("green.png") == work.read("out/view.png"));
}

// The orders of a hologram in one illumination state: together they have all the light that its samples represent.
TEST(Viewing, OrdersAddUpToTheEfficiency) {
  Workplace work;
  with_points(work).write("scene.toml", scene("[show]\nsubpixels = 3\n"));
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out"}).exit_code, 0);
  const auto stages = stages_of(work.read("out/report.json"));
  const auto& shown = stages.at("show");
  double sum = 0;
  int orders = 0;
  for (const auto& [name, value] : shown.items())
    if (name.starts_with("order_efficiency ")) {
      sum += value.get<double>();
      ++orders;
    }
  EXPECT_EQ(orders, 9);
  EXPECT_NEAR(sum, shown.at("efficiency").get<double>(), 1e-5);  // floats
  EXPECT_GT(shown.at("order_efficiency 0,0").get<double>(), 5 * shown.at("order_efficiency 1,0").get<double>());
  EXPECT_TRUE(stages.at("look at 30 mm").contains("uniformity"));
}

TEST(Viewing, ProgressOfManyIlluminationStatesAndViewsGoesOnceFromStartToEnd) {
  Workplace work;
  with_points(work).write(
      "scene.toml",
      scene("eye_separation = \"0.4 mm\"\n[show]\nsource_angle = \"0.1 deg\"\nillumination_states = 4\n") +
          "[trace]\nframes = 2\n[synthesize]\n");
  std::string text = work.read("scene.toml");
  text.replace(text.find("[trace]\nphase = \"constant\"\n"), 27, "");
  work.write("scene.toml", text);
  Job job = load_job(work.path("scene.toml"));
  job.camera.pupil = 0.6e-3;
  job.camera.sweep = Sweep::parallax;
  job.camera.sweep_from = -0.2e-3;
  job.camera.sweep_to = 0.2e-3;
  job.camera.sweep_views = 3;
  std::map<std::string, std::vector<double>> heard;
  std::mutex mutex;
  const RunResults results = run(job, [&](const std::string& stage) {
    Observer observer;
    observer.on_progress = [&, stage](double fraction) {
      const std::lock_guard lock(mutex);
      heard[stage].push_back(fraction);
    };
    return observer;
  });
  ASSERT_TRUE(heard.contains("2 holograms"));
  const auto& fractions = heard.at("2 holograms");
  EXPECT_NEAR(*std::max_element(fractions.begin(), fractions.end()), 1, 1e-12);
  EXPECT_LT(*std::min_element(fractions.begin(), fractions.end()), 0.05);
  EXPECT_FALSE(heard.contains("show"));
  EXPECT_EQ(results.sweep.images.size(), 3u);
  EXPECT_EQ(results.stereo_views.images.size(), 2u);
  EXPECT_EQ(results.stereo_renders.size(), 2u);
}

TEST(Viewing, NoiseComesAfterTheSumOfFramesAndCountsElectrons) {
  Workplace work;
  with_points(work).write("scene.toml", scene());
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out"}).exit_code, 0);
  const auto show_as = [&](const std::string& name, std::vector<std::string> flags) {
    flags.insert(flags.begin(), {"show", "-o", name, "--distance", "30 mm", "--exposure", "1"});
    EXPECT_EQ(work.run(flags).exit_code, 0);
    return load_image(work.path(name));
  };
  const Image still = show_as("still.exr", {"out/hologram.png"});
  const Image once = show_as("once.exr", {"out/hologram.png", "--electrons", "50"});
  // A hologram shown twice is the mean of two frames: the same light, and the noise of one reading.
  const Image twice = show_as("twice.exr", {"out/hologram.png", "out/hologram.png", "--electrons", "50"});
  EXPECT_EQ(once.values, twice.values);
  for (size_t i = 0; i < once.values.size(); ++i) {
    ASSERT_NEAR(std::round(once.values[i] * 50), once.values[i] * 50, 1e-4);  // whole electrons
    ASSERT_LE(once.values[i], 1);
    ASSERT_TRUE(still.values[i] > 0 || once.values[i] == 0);
  }
  EXPECT_NE(once.values, show_as("other.exr", {"out/hologram.png", "--electrons", "50", "--noise-seed", "2"}).values);
}

// A lens of f = 20 mm, 60 mm from the plane at 30 mm, images it at f/(s − f) = 1/2. A sensor of half the size, half
// as far off the axis, with pixels half as wide, sees what a sensor in that plane sees through the same pupil, except
// for a constant. So the picture is as close to the render, pixel by pixel, as that one.
TEST(Viewing, TheReferenceOfALensIsThePlaneThatItLooksAt) {
  Workplace work;
  with_points(work);
  const auto psnr_of = [&](double m, const std::string& lens) {
    const std::string camera = fmt::format(
        "[camera]\ndistances = \"30 mm\"\npupil = \"2 mm\"\neye = \"0 0 30 mm\"\n"
        "pixel = \"{} um\"\nwidth = \"{} mm\"\nheight = \"{} mm\"\n"
        "centre_x = \"{} mm\"\ncentre_y = \"{} mm\"\n{}[render]\nrows = 32\n",
        16 * m, 1.6 * m, 1.2 * m, 0.2 * m, -0.1 * m, lens);
    const std::string path = work.write("scene.toml", scene_head() + points_object() + camera);
    const RunResults results = run(load_job(path));
    for (const StageReport& stage : results.report.stages)
      for (const auto& [name, fact] : stage.facts)
        if (name == "psnr_db") return std::get<double>(fact);
    ADD_FAILURE() << "no metrics";
    return 0.0;
  };
  const double plain = psnr_of(1, ""), imaged = psnr_of(0.5, "focal_length = \"20 mm\"\n");
  EXPECT_NEAR(imaged, plain, 1e-3);  // floats
}

// The time of a stage for several holograms is the sum: here the first takes no time, the second 20 ms.
TEST(Viewing, SecondsOfRepeatedStagesAddUp) {
  Report report;
  const StageObserver watch;
  RepeatedStages repeat(2, 1, 2, report, watch);
  repeat("show", [](const Observer&) { return 0; });
  repeat("show", [](const Observer&) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return 0;
  });
  ASSERT_EQ(report.stages.size(), 1u);
  EXPECT_GE(report.stages[0].seconds, 0.02) << "a sleep is never shorter than asked for";
}

TEST(Viewing, SensorsAndLensesThatCannotBeAreRefusedBeforeTheFirstStage) {
  Workplace work;
  with_points(work);
  const auto refused = [&](const std::string& keys) {
    std::string text = scene();
    const std::string path = work.write("scene.toml", text.replace(text.find("[camera]\n"), 9, "[camera]\n" + keys));
    const std::string sentence = error_of([&] { check_job(load_job(path)); });
    return sentence.starts_with(path) ? sentence.substr(path.size() - std::string("scene.toml").size()) : sentence;
  };
  EXPECT_EQ(refused("read_noise = 2\n"),
            "expected electrons above 0 with a read noise of 2 electrons, got 0; set electrons");
  EXPECT_EQ(refused("focal_length = \"20 mm\"\n"),
            "expected a pupil above 0 m for a lens of 20 mm, got 0 m; give its diameter");
  EXPECT_EQ(refused("focal_length = \"50 mm\"\npupil = \"1 mm\"\n"),
            "expected a plane farther from the lens than its focal length of 50 mm, got one at 30 mm; move the "
            "eye back, or use a shorter focal length");
  EXPECT_EQ(refused("sweep = \"focus\"\n"),
            "expected a sweep between two places that differ, got 0 m and 0 m; give sweep_from and sweep_to "
            "(--sweep-from, --sweep-to)");
  const std::string head = scene().substr(0, scene().find("[camera]"));
  const std::string line = std::to_string(std::count(head.begin(), head.end(), '\n') + 2);  // the line after [camera]
  EXPECT_EQ(refused("sweep_views = 1\n"),
            "scene.toml:" + line + ":15: expected a whole number from 2 to 10000 for \"sweep_views\", got 1");
  EXPECT_EQ(refused("sweep_seconds = 0\n"),
            "scene.toml:" + line + ":17: expected a number above 0, up to 3600 for \"sweep_seconds\", got 0");
}

}  // namespace
}  // namespace holotrace::test
