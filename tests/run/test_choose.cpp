#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "holotrace/data/acceptance.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/renders.h"
#include "support/panels.h"

namespace holotrace {
namespace {

Job empty_job() {
  Job job;
  job.wavelengths = {test_wavelength};
  job.slm = make_panel(1920, 1080);  // 8 µm: 15.36 mm × 8.64 mm
  return job;
}

const Chosen* chosen_for(const Job& job, const std::string& parameter) {
  const auto found =
      std::find_if(job.chosen.begin(), job.chosen.end(), [&](const Chosen& one) { return one.parameter == parameter; });
  return found == job.chosen.end() ? nullptr : &*found;
}

TEST(Choose, AJobThatGivesNothingGetsTheOptimisedPicture) {
  const Job job = choose_missing(empty_job());
  EXPECT_EQ(job.encode.method, Encoding::sgd);
  EXPECT_EQ(job.encode.target, EncodeTarget::render);
  EXPECT_EQ(job.encode.quality, Quality::draft);
  EXPECT_GT(job.trace.frames, 0);
  EXPECT_GT(job.encode.planes, 0);
  EXPECT_GT(job.encode.iterations, 0);
  EXPECT_GT(job.render.paths, 0);
  ASSERT_NE(chosen_for(job, "encode.method"), nullptr);
  EXPECT_EQ(chosen_for(job, "encode.method")->value, "sgd");
  EXPECT_EQ(chosen_for(job, "encode.method")->why, "no parameter of waves is given");
  EXPECT_TRUE(job.warnings.empty());
}

// A wall 80 mm behind the panel, and one 20 mm in front of it.
TEST(Choose, TheCameraFocusesOnTheSceneIfNoDistanceIsGiven) {
  for (const double depth : {0.08, -0.02}) {
    Job job = empty_job();
    job.scene.materials = {Material(DiffuseMaterial{}, {1, 1, 1})};
    Mesh wall;
    wall.positions = {{-5e-3, -5e-3, -depth}, {5e-3, -5e-3, -depth}, {0, 5e-3, -depth}};
    wall.triangles = {{0, 1, 2}};
    job.scene.meshes = {wall};
    EXPECT_EQ(choose_missing(job).camera.distances, (std::vector<double>{0.3}));  // as given
    job.are_distances_given = false;
    const Job chosen = choose_missing(job);
    ASSERT_EQ(chosen.camera.distances.size(), 1u);
    EXPECT_NEAR(chosen.camera.distances[0], depth, 1e-12);
    EXPECT_EQ(chosen_for(chosen, "camera.distances")->why, "the middle of the scene's depths");
    EXPECT_EQ(choose_missing(chosen).chosen.size(), chosen.chosen.size());
  }
}

// What a single frame cannot show well takes several. The scene is empty, so it has no depth.
TEST(Choose, DraftsOfOneFrameNeedASmoothStart) {
  const auto frames = [](const std::function<void(Job&)>& change, Goal goal = Goal::picture) {
    Job job = empty_job();
    change(job);
    return choose_missing(job, goal).trace.frames;
  };
  EXPECT_EQ(frames([](Job&) {}), 1);
  EXPECT_EQ(frames([](Job& job) { job.encode.levels = 4; }), 4);
  EXPECT_EQ(frames([](Job& job) { job.encode.levels = 5; }), 1);
  EXPECT_EQ(frames([](Job& job) { job.encode.target = EncodeTarget::light_field; }), 4);
  EXPECT_EQ(frames([](Job& job) { job.encode.start = StartPhase::random; }), 4);
  EXPECT_EQ(frames([](Job& job) {
              job.encode.eye = {0, 0, 0.25};
              job.encode.eyebox = {"all"};
            }),
            4);
  EXPECT_EQ(frames([](Job& job) { job.encode.eye = {0, 0, 0.25}; }), 1);
  EXPECT_EQ(frames([](Job& job) {
              job.wavelengths = {638e-9, 532e-9};
              job.encode.is_joint = true;
            }),
            4);
  EXPECT_EQ(frames([](Job& job) {
              job.slm.effects.crosstalk = 0.2;
              job.slm.own_effects = {"crosstalk"};
            }),
            4);
  EXPECT_EQ(frames([](Job&) {}, Goal::waves), 1);
}

// The table of choose.h; here without the library of denoising, which needs fewer paths.
TEST(Choose, EachQualityHasItsEffort) {
  using Effort = std::vector<int>;  // frames, planes, iterations, paths
  const auto effort = [](Quality quality, bool has_eye) {
    Job job = empty_job();
    job.encode.quality = quality;
    job.encode.denoise = Denoise::none;
    if (has_eye) job.encode.eye = {0, 0, 0.25};
    job = choose_missing(job);
    return Effort{job.trace.frames, job.encode.planes, job.encode.iterations, job.render.paths};
  };
  EXPECT_EQ(effort(Quality::draft, false), (Effort{1, 4, 30, 32}));
  EXPECT_EQ(effort(Quality::good, false), (Effort{8, 16, 70, 128}));
  EXPECT_EQ(effort(Quality::best, false), (Effort{16, 24, 200, 256}));
  EXPECT_EQ(effort(Quality::draft, true), (Effort{1, 10, 100, 32}));
  EXPECT_EQ(effort(Quality::good, true), (Effort{4, 16, 160, 64}));
  EXPECT_EQ(effort(Quality::best, true), (Effort{8, 16, 250, 128}));
}

TEST(Choose, TargetsThatAreDenoisedNeedFewerPaths) {
  Job job = empty_job();
  if (!can_denoise_targets(job)) GTEST_SKIP() << "no library of denoising here";
  EXPECT_EQ(choose_missing(job).render.paths, 32 / 8);
  job.encode.eye = {0, 0, 0.25};
  EXPECT_EQ(choose_missing(job).render.paths, 32 / 4);
}

// Each of these only waves have; the reason names it.
TEST(Choose, AParameterOfWavesAsksForWaves) {
  const std::vector<std::pair<std::string, std::function<void(Job&)>>> cases{
      {"trace.columns", [](Job& job) { job.trace.columns = 256; }},
      {"trace.rows", [](Job& job) { job.trace.rows = 256; }},
      {"trace.strategy", [](Job& job) { job.trace.strategy = Strategy::gather; }},
      {"trace.pattern", [](Job& job) { job.trace.pattern = Pattern::random; }},
      {"trace.phase", [](Job& job) { job.trace.phase = SourcePhase::laser; }},
      {"trace.separate_lights", [](Job& job) { job.trace.separate_lights = true; }},
      {"trace.separate_path_groups", [](Job& job) { job.trace.separate_path_groups = true; }},
      {"synthesize.method", [](Job& job) { job.synthesize.method = SynthesisMethod::triangles; }},
      {"synthesize.tolerance", [](Job& job) { job.synthesize.tolerance = 1e-4; }},
      {"lasers",
       [](Job& job) {
         job.scene.lights = {PointLight{{}, {1, 1, 1}, true}};
       }},
      {"the panel itself", [](Job& job) {
         job.camera.distances = {0.3, 0};
       }}};
  for (const auto& [name, change] : cases) {
    SCOPED_TRACE(name);
    Job job = empty_job();
    change(job);
    job = choose_missing(job);
    EXPECT_EQ(job.encode.method, Encoding::phase);
    EXPECT_EQ(job.encode.target, EncodeTarget::field);
    EXPECT_EQ(job.trace.frames, 1);
    EXPECT_EQ(job.encode.iterations, 0);
    EXPECT_NE(chosen_for(job, "encode.method")->why.find(name), std::string::npos);
  }
}

TEST(Choose, WhatAllPicturesHaveDoesNotAskForWaves) {
  Job job = empty_job();
  job.trace.frames = 3;
  job.trace.paths = 7;
  job.trace.max_depth = 3;
  job.trace.path_expressions = {"E.*L"};
  job.trace.seed = 9;
  job.synthesize.device.kind = DeviceKind::opencl;
  job.encode.image = ImageSide::real_image;
  job = choose_missing(job);
  EXPECT_EQ(job.encode.method, Encoding::sgd);
  EXPECT_EQ(job.trace.frames, 3);
  EXPECT_EQ(job.encode.device.kind, DeviceKind::opencl);  // where the waves would have been summed
}

TEST(Choose, AQualityOrATargetAsksForThePicture) {
  for (const bool by_quality : {true, false}) {
    Job job = empty_job();
    job.trace.columns = 256;
    if (by_quality)
      job.encode.quality = Quality::good;
    else
      job.encode.target = EncodeTarget::light_field;
    job = choose_missing(job);
    EXPECT_EQ(job.encode.method, Encoding::sgd);
    EXPECT_EQ(job.encode.target, by_quality ? EncodeTarget::render : EncodeTarget::light_field);
    ASSERT_EQ(job.warnings.size(), 1u);
    EXPECT_NE(job.warnings[0].find("trace.columns: not used"), std::string::npos);
  }
}

TEST(Choose, WhatIsGivenStays) {
  Job job = empty_job();
  job.encode.method = Encoding::sgd;
  job.encode.quality = Quality::good;
  job.trace.frames = 1;
  job.encode.iterations = 7;
  job.encode.planes = 2;
  job.render.paths = 5;
  job.render.columns = 100;
  job.render.rows = 50;
  job.render.field_of_view = 0.01;
  const Job chosen = choose_missing(job);
  EXPECT_EQ(chosen.trace.frames, 1);
  EXPECT_EQ(chosen.encode.iterations, 7);
  EXPECT_EQ(chosen.encode.planes, 2);
  EXPECT_EQ(chosen.render.paths, 5);
  EXPECT_EQ(chosen.render.columns, 100);
  EXPECT_EQ(chosen.render.field_of_view, 0.01);
  ASSERT_EQ(chosen.chosen.size(), 1u);
  EXPECT_EQ(chosen.chosen[0].parameter, "encode.target");
  EXPECT_EQ(choose_missing(chosen).chosen.size(), 1u);  // nothing is left to choose
}

TEST(Choose, OtherMethodsKeepTheirTarget) {
  Job job = empty_job();
  job.encode.method = Encoding::gerchberg_saxton;
  EXPECT_EQ(choose_missing(job).encode.target, EncodeTarget::field);
  EXPECT_TRUE(choose_missing(job).warnings.empty());
  job.encode.quality = Quality::best;
  ASSERT_EQ(choose_missing(job).warnings.size(), 1u);
  EXPECT_TRUE(choose_missing(job).warnings[0].starts_with(
      "quality best: not used, because the method gerchberg-saxton does not"));
  job.encode.quality = Quality::automatic;
  job.encode.method = Encoding::sgd;
  job.trace.columns = 300;  // the light of these waves
  EXPECT_EQ(choose_missing(job).encode.target, EncodeTarget::field);
}

TEST(Choose, APupilInFrontOfThePanelIsAnEyeThatTheLightIsFor) {
  Job job = empty_job();
  job.camera.pupil = 3e-3;
  EXPECT_EQ(choose_missing(job).encode.target, EncodeTarget::render);
  job.camera.eye = {0, 0, 0.2};
  const Job chosen = choose_missing(job);
  EXPECT_EQ(chosen.encode.target, EncodeTarget::render);
  EXPECT_EQ(chosen.encode.eye, (std::vector<double>{0, 0, 0.2}));
  EXPECT_EQ(chosen.encode.pupil, 3e-3);
  EXPECT_EQ(chosen.trace.frames, 1);         // draft
  job.encode.target = EncodeTarget::render;  // asked for: the light of the whole panel
  EXPECT_TRUE(choose_missing(job).encode.eye.empty());
}

TEST(Choose, WavesAreEncodedAsThePanelModulates) {
  Job job = empty_job();
  job.trace.columns = 300;
  job.slm.modulation = Modulation::amplitude;
  EXPECT_EQ(choose_missing(job).encode.method, Encoding::off_axis);
  job.slm.modulation = Modulation::complex;
  EXPECT_EQ(choose_missing(job).encode.method, Encoding::complex);
  job.trace.columns = 0;
  EXPECT_EQ(choose_missing(job).encode.method, Encoding::sgd);
  EXPECT_EQ(choose_missing(job, Goal::waves).encode.method, Encoding::complex);
}

// The sensor is as large as the panel unless the camera says otherwise: 15.36 mm × 8.64 mm, 512 rows.
TEST(Choose, TheRenderHasTheWindowOfTheView) {
  Job job = empty_job();
  job.camera.distances = {0.3, 0.2};  // the nearer one needs the larger angle
  Job chosen = choose_missing(job);
  EXPECT_EQ(chosen.render.columns, 910);  // 512·16/9
  EXPECT_NEAR(std::tan(chosen.render.field_of_view), 4.32e-3 / 0.2, 1e-12);
  job.render.columns = job.render.rows = 64;  // a square holds the width
  EXPECT_NEAR(std::tan(choose_missing(job).render.field_of_view), 7.68e-3 / 0.2, 1e-12);
  job = empty_job();
  job.camera.width = 4e-3;
  job.camera.height = 2e-3;
  job.camera.centre_y = 1e-3;
  job.render.rows = 100;
  chosen = choose_missing(job);
  EXPECT_EQ(chosen.render.columns, 100);  // ±2 mm × ±(1 + 1) mm
  EXPECT_NEAR(std::tan(chosen.render.field_of_view), 2e-3 / 0.3, 1e-12);
}

// Waves lie λd/w apart, w the panel's width or height, in the square of half the view's width.
TEST(Choose, WavesBeginInTheWindowOfTheView) {
  Job job = empty_job();
  job.camera.distances = {0.3};
  Job chosen = choose_missing(job, Goal::waves);
  EXPECT_NEAR(std::tan(chosen.trace.field_of_view), 7.68e-3 / 0.3, 1e-12);
  // 15.36 mm/(532 nm·300 mm/15.36 mm) = 1478.2 columns and 831.5 rows are more than 1024·768.
  EXPECT_EQ(chosen.trace.columns, int(1478.2 * std::sqrt(1024 * 768 / (1478.2 * 831.5))));
  EXPECT_LE(chosen.trace.columns * chosen.trace.rows, 1024 * 768);
  EXPECT_NEAR(double(chosen.trace.columns) / chosen.trace.rows, 16.0 / 9, 0.01);
  job.camera.distances = {0.6};
  chosen = choose_missing(job, Goal::waves);
  EXPECT_EQ(chosen.trace.columns, 739);
  EXPECT_EQ(chosen.trace.rows, 415);
  job.camera.eye = {0, 0, 0.1};  // sees more than the window
  EXPECT_EQ(choose_missing(job, Goal::waves).trace.field_of_view, 0);
  job = empty_job();
  job.slm = make_panel(64, 64);
  chosen = choose_missing(job, Goal::waves);
  EXPECT_EQ(chosen.trace.columns, default_raster);
  EXPECT_EQ(chosen.trace.rows, default_raster);
}

}  // namespace
}  // namespace holotrace
