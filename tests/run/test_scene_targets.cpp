#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numeric>

#include "holotrace/data/acceptance.h"
#include "holotrace/run/choose.h"
#include "holotrace/run/eye_views.h"
#include "holotrace/run/pipeline.h"
#include "holotrace/run/renders.h"
#include "holotrace/run/scene_targets.h"
#include "holotrace/slm/panel/show.h"
#include "holotrace/view/camera.h"
#include "holotrace/view/compare.h"
#include "support/panels.h"

namespace holotrace {
namespace {

// A luminous square of side 0.3 mm at 20 mm, and one of side 0.4 mm behind it at 24 mm, displaced sideways.
Job two_squares() {
  Job job;
  job.wavelengths = {test_wavelength};
  job.slm = make_panel(160, 120);
  Material lamp;
  lamp.emission = {1, 1, 1};
  job.scene.materials = {lamp};
  const auto square = [](double x, double depth, double side) {
    Mesh mesh;
    const double h = side / 2;
    mesh.positions = {{x - h, -h, -depth}, {x + h, -h, -depth}, {x + h, h, -depth}, {x - h, h, -depth}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
  };
  job.scene.meshes = {square(-2e-4, 0.02, 3e-4), square(2.5e-4, 0.024, 4e-4)};
  job.encode.method = Encoding::sgd;
  job.encode.target = EncodeTarget::render;
  job.render.paths = 16;
  job.camera.distances = {0.02};
  return job;
}

// One depth of focus in 1/distance: 2λ/w² with w = 1.28 mm.
constexpr double depth_of_focus = 2 * test_wavelength / (1.28e-3 * 1.28e-3);

TEST(SceneTargets, PlanesGoOneDepthOfFocusBeyondTheSceneAndIncludeThoseOfTheCamera) {
  Job job = two_squares();
  job.encode.planes = 3;
  const double near = 1 / 0.02 + depth_of_focus, far = 1 / 0.024 - depth_of_focus;
  const std::vector<double> few = target_distances_of(job);
  ASSERT_EQ(few.size(), 4u);
  EXPECT_NEAR(few[0], 1 / near, 1e-7);
  EXPECT_EQ(few[1], 0.02);                          // the camera's
  EXPECT_NEAR(1 / few[2], (near + far) / 2, 1e-3);  // evenly spaced in 1/distance
  EXPECT_NEAR(few[3], 1 / far, 1e-7);
  // 9.63/m in steps of at most 0.649/m: 15 steps, 16 planes, of which the second is nearly that of the camera and becomes it.
  job.encode.planes = 100;
  const std::vector<double> all = target_distances_of(job);
  EXPECT_EQ(all.size(), 16u);
  EXPECT_EQ(all[1], 0.02);
  for (size_t i = 1; i < all.size(); ++i) EXPECT_LE(1 / all[i - 1] - 1 / all[i], 1.1 * depth_of_focus);
  job.encode.target_distances = {0.021};
  EXPECT_EQ(target_distances_of(job), (std::vector<double>{0.021}));
  job.encode.target_distances = {};
  job.scene = {};
  EXPECT_THROW(target_distances_of(job), Error);
}

// From 1/0.02 m to 1/0.024 m there are 8.33/m, or 12.8 depths of focus. Nearer than w/(2·tan θ) = 19.24 mm points have light of a
// part of the panel, and the depth of focus is λ/(2·tan²θ) = 0.2404 mm: 38.44 of them from there to 10 mm, and 15.88 from there to
// 24 mm. Drafts have one frame for up to 40, and four for deeper scenes.
TEST(SceneTargets, DraftsOfDeepScenesHaveSeveralFrames) {
  Job job = two_squares();
  EXPECT_NEAR(depth_of_scene(job), 8.33 / depth_of_focus, 0.1);
  EXPECT_EQ(choose_missing(job).trace.frames, 1);
  for (Vec3& position : job.scene.meshes.front().positions) position.z = -0.01;
  EXPECT_NEAR(depth_of_scene(job), 38.44 + 15.88, 0.1);
  const Job chosen = choose_missing(job);
  EXPECT_EQ(chosen.trace.frames, 4);
  job.encode.quality = Quality::good;
  EXPECT_EQ(choose_missing(job).trace.frames, 8);
  job.scene = {};
  EXPECT_EQ(depth_of_scene(job), 0);
}

// Depths in front of the panel are negative, and the scale is odd: planes through a scene and through its mirror image are the same
// but for their sign. A scene through the panel has planes on both sides, no farther apart than the depth of focus.
TEST(SceneTargets, PlanesGoThroughScenesInFrontOfThePanel) {
  Job behind = two_squares();
  behind.encode.planes = 100;
  Job front = behind;
  for (Mesh& mesh : front.scene.meshes)
    for (Vec3& p : mesh.positions) p.z *= -1;
  front.camera.distances = {-0.02};
  std::vector<double> mirrored = target_distances_of(behind);
  std::reverse(mirrored.begin(), mirrored.end());
  const std::vector<double> distances = target_distances_of(front);
  ASSERT_EQ(distances.size(), mirrored.size());
  for (size_t i = 0; i < distances.size(); ++i) EXPECT_NEAR(distances[i], -mirrored[i], 1e-9);

  Job through = behind;
  for (Vec3& p : through.scene.meshes.front().positions) p.z = 1e-3;
  for (Vec3& p : through.scene.meshes.back().positions) p.z = -2e-3;
  through.camera.distances = {-1e-3, 2e-3};
  const std::vector<double> both = target_distances_of(through);
  EXPECT_LT(both.front(), -1e-3);
  EXPECT_GT(both.back(), 2e-3);
  for (size_t i = 1; i < both.size(); ++i)
    EXPECT_LE(both[i] - both[i - 1], 0.2404e-3 * 1.11);  // the camera's planes move some
}

TEST(SceneTargets, WarnOfPlanesThatAreFartherApartThanTheDepthOfFocus) {
  Job job = two_squares();
  const auto warnings = [&](std::vector<double> distances) {
    job.encode.target_distances = std::move(distances);
    Heard heard;
    warn_of_sparse_planes(job, heard.observer());
    return heard.warnings;
  };
  EXPECT_TRUE(warnings({0.02, 1 / (1 / 0.02 - depth_of_focus)}).empty());
  const std::vector<std::string> sparse = warnings({0.024, 0.02});  // 8.33/m, 12.8 times as much
  ASSERT_EQ(sparse.size(), 1u);
  EXPECT_TRUE(sparse.front().starts_with("the target planes at 20 mm and 24 mm are 12.8 depths of focus")) << sparse[0];
  EXPECT_NE(sparse.front().find("3.7 dB worse"), std::string::npos) << sparse[0];  // 1.2·log₂(12.8/1.5)
}

// A luminous square of side 0.3 mm at 20 mm looks toward a mirror at 30 mm: its image is at 40 mm.
Job square_before_a_mirror() {
  Job job = two_squares();
  job.scene.materials.emplace_back(ConductorMaterial{});
  job.scene.meshes.resize(1);
  Mesh mirror = job.scene.meshes.front();
  for (Vec3& position : mirror.positions) position = {(position.x + 2e-4) * 10, position.y * 10, -0.03};
  mirror.material = 1;
  job.scene.meshes.push_back(mirror);
  return job;
}

TEST(SceneTargets, PlanesGoThroughImagesInMirrorsToo) {
  Job job = square_before_a_mirror();
  job.encode.planes = 100;
  const std::vector<double> distances = target_distances_of(job);
  // The surfaces, at 20 and 30 mm, are 16.7/m apart, with a depth of focus at both ends 18.0/m: 28 steps of 0.649/m, 29 planes.
  // The image has a plane on either side of its own.
  ASSERT_EQ(distances.size(), 32u);
  EXPECT_NEAR(distances.front(), 1 / (1 / 0.02 + depth_of_focus), 1e-6);
  EXPECT_NEAR(distances[28], 1 / (1 / 0.03 - depth_of_focus), 1e-6);
  EXPECT_NEAR(distances[30], 0.04, 1e-6);
  job.encode.planes = 4;
  const std::vector<double> few = target_distances_of(job);
  ASSERT_EQ(few.size(), 5u);  // with the camera's
  EXPECT_NEAR(few[2], 1 / (1 / 0.03 - depth_of_focus), 1e-6);
  EXPECT_NEAR(few.back(), 1 / (1 / 0.04 - depth_of_focus), 1e-6);
  job.encode.planes = 1;  // in the middle of all, in 1/distance
  EXPECT_NEAR(target_distances_of(job).back(), 2 / (1 / 0.02 + 1 / 0.04), 1e-6);
  job.scene.materials[1].surface = DiffuseMaterial{};  // without a mirror there is no image
  job.encode.planes = 100;
  EXPECT_EQ(target_distances_of(job).size(), 29u);
}

TEST(SceneTargets, AmplitudeIsTheRootOfTheRadiance) {
  Job job = two_squares();
  job.encode.target_distances = {0.02, 0.024};
  job.encode.denoise = Denoise::none;
  const SceneTargets targets = trace_targets(job);
  const TargetSet set = targets_of(targets, job, {test_wavelength});
  ASSERT_EQ(set.planes.size(), 2u);
  EXPECT_EQ(set.planes[0].z, -0.02);
  EXPECT_FALSE(set.draw_views);
  // In the middle of the near square there is its radiance of 1, to the rounding of floats, and black beside it: nothing is
  // blurred. A pixel at its edge shares its light: 37.5 pixels are 0.3 mm.
  const Grid& grid = job.slm.grid;
  const int column = int(std::lround((-2e-4 - grid.x(0)) / grid.pitch));
  EXPECT_NEAR(set.planes[0].amplitude(60, column), 1, 1e-5);
  EXPECT_NEAR(set.planes[0].amplitude(60 - 17, column), 1, 1e-5);
  EXPECT_EQ(set.planes[0].amplitude(60 - 21, column), 0);
}

TEST(SceneTargets, ViewsSendTheLightOfTheirPupil) {
  // Pupils side by side over the eye's window pass part of the light that the planes have; none more than all.
  Job job = two_squares();
  job.encode.target = EncodeTarget::light_field;
  job.encode.target_distances = {0.02};
  job.camera.eye.z = 0.3;
  const SceneTargets targets = trace_targets(job);
  const TargetSet set = targets_of(targets, job, {test_wavelength});
  ASSERT_TRUE(set.draw_views);
  const ViewTargets views = set.draw_views(1, test_wavelength);
  ASSERT_EQ(views.amplitudes.size(), views.pupils.size());
  ASSERT_FALSE(views.pupils.empty());
  for (const Pupil& pupil : views.pupils) {
    EXPECT_EQ(pupil.centre.z, 0.3);
    EXPECT_EQ(pupil.diameter, 2e-3);
  }
  job.camera.pupil = 3.5e-3;
  EXPECT_EQ(targets_of(targets, job, {test_wavelength}).draw_views(1, test_wavelength).pupils.front().diameter, 3.5e-3);
  // In the middle of the near square: a 2 mm pupil at 300 mm is a disc of 2 mm·20/320 = 0.125 mm on the panel, 0.0100 of
  // the 1.28 × 0.96 mm that a place on the axis sees. The pupil's Airy radius is 0.104 mm, so about 7 % of the light of a
  // square of 0.3 mm is missing in its middle, and there is as much uncertainty in that.
  const Pupil pupil{{0, 0, 0.3}, 2e-3};
  const Grid& grid = job.slm.grid;
  const ViewTargets view = views_of(light_for_pupil(*targets.light_field, test_wavelength, 2e-3, 0.3), job, 0.02,
                                    test_wavelength, {pupil}, grid, grid);
  const int column = int(std::lround((-2e-4 - grid.x(0)) / grid.pitch));
  EXPECT_NEAR(std::pow(view.amplitudes[0](60, column), 2), 0.0100 * 0.93, 0.0007);
  // Its plane: the part of the panel within 0.665 mm of that place is 1.105 mm wide.
  EXPECT_NEAR(std::pow(set.planes[0].amplitude(60, column), 2), 1.105 / 1.28, 0.03);
}

// Pixels without gaps dim the light of a panel that is wide for its distance, blue more than red: sinc² at the panel's edge is
// 0.63 at 450 nm. Iterations fit each colour to the traced light, so the squares, which are white, stay white.
TEST(SceneTargets, ColoursAreAsBrightAsTheirTargets) {
  Job job = two_squares();
  job.wavelengths = {638e-9, 520e-9, 450e-9};
  job.slm.fill_factor = 1;
  job.encode.iterations = 40;
  job.encode.target_distances = {0.02};
  job.trace.frames = 2;
  const RunResults results = run(job);
  for (const Hologram& hologram : results.holograms) EXPECT_FALSE(hologram.losses.by_cone || hologram.losses.by_pixels);
  const Image& view = results.views.front();
  ASSERT_EQ(view.channels, 3);
  Vec3 sum;  // over the near square, 38 pixels wide, but for its edge
  const int middle = int(std::lround((-2e-4 - job.slm.grid.x(0)) / job.slm.grid.pitch)),
            binned = job.slm.grid.nx / view.nx;
  for (int j = -12; j <= 12; ++j)
    for (int i = -12; i <= 12; ++i) {
      const float* c = &view.values[3 * (size_t(60 + j) / binned * size_t(view.nx) + size_t(middle + i) / binned)];
      sum = sum + Vec3{c[0], c[1], c[2]};
    }
  EXPECT_NEAR(sum.x / sum.y, 1, 0.02);  // the goal of 2 %; each colour is fitted to some 30 dB
  EXPECT_NEAR(sum.z / sum.y, 1, 0.02);
}

TEST(SceneTargets, RunShowsTheTracedLight) {
  Job job = two_squares();
  job.encode.iterations = 40;
  job.encode.planes = 5;  // eight turns for each
  job.trace.frames = 4;
  const RunResults results = run(job);
  EXPECT_EQ(results.holograms.size(), 4u);
  EXPECT_TRUE(results.sources.empty());
  EXPECT_TRUE(results.fields.empty());
  EXPECT_EQ(results.report.stages.front().stage, "focal stack");
  const auto psnr = [](const RunResults& shown) {  // of the view
    for (const StageReport& stage : shown.report.stages)
      for (const auto& [name, value] : stage.facts)
        if (stage.stage.starts_with("look") && name == "psnr_db") return std::get<double>(value);
    return 0.0;
  };
  job.encode.iterations = 1;
  job.encode.start = StartPhase::random;
  EXPECT_GT(psnr(results), psnr(run(job)) + 5);  // a third of the error, or less
}

double fact_of(const Report& report, const std::string& stage, const std::string& name) {
  for (const StageReport& entry : report.stages)
    for (const auto& [key, value] : entry.facts)
      if (entry.stage.starts_with(stage) && key == name) return std::get<double>(value);
  return 0;
}

// One hologram for each frame, lit with both colours. Each colour has the brightness of the scene; the view in both is
// near the render, which frames of random phases are not.
TEST(SceneTargets, JointHologramsShowAllColours) {
  Job job = two_squares();
  job.wavelengths = {test_wavelength, 633e-9};
  job.encode.is_joint = true;
  job.slm.phase_range = 4 * pi;  // colours differ where phases wrap at different levels
  job.encode.planes = 3;
  job.encode.iterations = 60;
  job.trace.frames = 2;
  const RunResults results = run(job);
  ASSERT_EQ(results.holograms.size(), 2u);
  for (const Hologram& hologram : results.holograms) {
    ASSERT_EQ(hologram.colours.size(), 2u);
    EXPECT_EQ(hologram.colours[1].wavelength, 633e-9);
    EXPECT_EQ(hologram.colours[0].illumination, hologram.illumination);
    EXPECT_GT(hologram.colours[1].illumination, 0);
  }
  EXPECT_EQ(results.views.front().channels, 3);
  job.encode.iterations = 1;
  const double before = fact_of(run(job).report, "look", "psnr_db");
  EXPECT_GT(fact_of(results.report, "look", "psnr_db"), before + 3);  // half the error, or less
  job.encode.target = EncodeTarget::field;
  EXPECT_THROW(check_job(job), Error);
}

// The squares for an eye with a pupil of 0.5 mm.
Job squares_for_an_eye() {
  Job job = two_squares();
  job.encode.eye = {1e-4, -5e-5, 0.02};
  job.encode.pupil = 5e-4;
  job.encode.eyebox = {"0.2 mm"};
  return with_eyes(job);
}

// From an eye near the panel the plane goes on beyond the rays that the panel can send: of the wall 20 mm behind the panel a pupil 4 mm
// before it sees (20 + 4) mm·tan θ around each of its places, θ the steepest of the panel's rays.
TEST(SceneTargets, AnEyeNearThePanelSeesWhatItsRaysReach) {
  Job job = squares_for_an_eye();
  job.encode.eye = {0, 0, 4e-3};
  const double distance = 20e-3, aside = (0.2e-3 + 0.5e-3 / 6 + 0.5e-3) / 2;
  const LightField light = trace_eye_light(job, distance, RenderParams{.paths = 1}).front().light;
  const double reach = aside + (distance + 4e-3) * acceptance_tangent(test_wavelength, test_pitch);
  const double through_panel = job.slm.grid.width() * (distance + 4e-3) / 4e-3 + 2 * aside * distance / 4e-3;
  ASSERT_GT(through_panel, 3 * reach);
  EXPECT_GE(light.plane.width(), 2 * reach) << "rays along an axis; those across both are a little steeper";
  EXPECT_LE(light.plane.width(), 2 * reach * 1.01);
}

// Pupils of F frames are at r = R·√v·(√v)^(2/F) from the eye, v even in 0 … 1: 1/2.5 of R in the mean for one frame, 2/3 for very
// many. R is the radius of the eyebox, 0.1 mm, and a twelfth of a pupil.
TEST(Eyes, PupilsOfFewFramesAreNearerToTheEye) {
  Job job = squares_for_an_eye();
  job.render.paths = 1;
  const auto kept = trace_targets(job).eyes;
  const LightField& light = kept->lights.front().lights.front();
  const Vec3 eye{1e-4, -5e-5, 0.02};
  const double radius = 0.1e-3 + 0.5e-3 / 12;
  const auto mean_radius = [&](int frames) {
    job.trace.frames = frames;
    double sum = 0, most = 0;
    constexpr int draws = 400;
    for (int update = 0; update < draws; ++update) {
      const Vec3 at = draw_view_in_box(eye, light, job, {0.02}, update, test_wavelength).pupils.front().centre;
      const Vec3 aside = at - eye;
      most = std::max(most, length(aside));
      sum += length(aside);
    }
    EXPECT_LE(most, radius * (1 + 1e-9));
    EXPECT_GT(most, 0.9 * radius);
    return sum / draws / radius;
  };
  EXPECT_NEAR(mean_radius(1), 0.4, 0.05);  // 400 draws: ±0.015
  EXPECT_NEAR(mean_radius(1000), 2.0 / 3, 0.05);
}

TEST(Eyes, AreThoseOfTheCamera) {
  const Job job = squares_for_an_eye();
  EXPECT_EQ(job.camera.eye, (Vec3{1e-4, -5e-5, 0.02}));
  EXPECT_EQ(job.camera.pupil, 5e-4);
  Job other = two_squares();
  other.encode.eye = {0, 0, 0.02};
  other.camera.pupil = 7e-4;
  other.camera.eye = {1e-4, 0, 0.02};  // looks from beside
  EXPECT_EQ(with_eyes(other).encode.pupil, 7e-4);
  EXPECT_EQ(with_eyes(other).camera.eye.x, 1e-4);
  other.encode.eyebox = {"all"};
  EXPECT_EQ(with_eyes(other).encode.target, EncodeTarget::light_field);
  EXPECT_FALSE(aims_at_eyes(with_eyes(other)));
}

TEST(Eyes, DepthOfFocusIsThatOfThePupil) {
  // Planes at most 2λ/D² = 4.26/m apart in the reciprocal distance from the eye, through the scene alone: 1/0.04 − 1/0.044 =
  // 2.27/m, two planes.
  Job job = squares_for_an_eye();
  const std::vector<double> distances = target_distances_of(job);
  ASSERT_EQ(distances.size(), 2u);
  EXPECT_NEAR(distances.front(), 0.02, 1e-9);
  EXPECT_NEAR(distances.back(), 0.024, 1e-6);
}

// The planes of an eye that walks are those of one distance, so that each time has them whichever is found first.
TEST(Eyes, ThatWalkHaveTheSamePlanesEverywhere) {
  Job near = squares_for_an_eye();
  near.encode.pupil *= 2;  // four planes, of which the two in the middle depend on the eye
  Job far = near;
  far.encode.eye[2] *= 1.1;
  EXPECT_NE(target_distances_of(near), target_distances_of(far));
  EXPECT_EQ(target_distances_of(near), target_distances_of(far, near.encode.eye[2]));
}

TEST(Eyes, ViewsAreDrawnInTheBoxAndHaveTheLightOfTheirPupil) {
  // As for the pupils of a light field: 2 mm at 300 mm, and the same 1 % of the light, less 7 % by diffraction.
  Job job = two_squares();
  job.encode.eye = {0, 0, 0.3};
  job.encode.pupil = 2e-3;
  job.encode.eyebox = {"2 1 mm"};
  const SceneTargets targets = trace_targets(job);
  const TargetSet set = targets_of(targets, job, {test_wavelength});
  EXPECT_TRUE(set.planes.empty());
  ASSERT_EQ(set.views.size(), targets.distances.size());
  EXPECT_EQ(set.eyes, (std::vector<Vec3>{{0, 0, 0.3}}));
  const ViewTargets& view = set.views.front();
  const Grid& picture = view.picture;
  const int column = int(std::lround((-2e-4 - picture.x(0)) / picture.pitch));
  const double off =
      (picture.x(column) + 2e-4) / picture.pitch;  // the sample that is nearest to the middle of the square
  ASSERT_LT(std::abs(off), 0.5);
  EXPECT_NEAR(std::pow(view.amplitudes[0](picture.ny / 2, column), 2), 0.0100 * 0.93, 0.0015);
  double least = 0, most = 0, highest = 0;
  for (int update = 0; update < 60; ++update) {
    const ViewTargets drawn = set.draw_views(update, test_wavelength);
    ASSERT_EQ(drawn.pupils.size(), 1u);
    least = std::min(least, drawn.pupils[0].centre.x);
    most = std::max(most, drawn.pupils[0].centre.x);
    highest = std::max(highest, std::abs(drawn.pupils[0].centre.y));
    EXPECT_EQ(drawn.window, view.window);
  }
  // The box, and a twelfth of a pupil more on each side; of 60 draws the largest is 3 % of the width from its edge in the mean.
  EXPECT_LE(most, 1e-3 + 2e-3 / 12);
  EXPECT_GT(most, 0.8e-3);
  EXPECT_LT(least, -0.8e-3);
  EXPECT_LE(highest, 0.5e-3 + 2e-3 / 12);
}

// The camera's pupil is to overlap with one in the eyebox of 0.2 mm: within 0.1 + 0.5 mm of the eye.
TEST(Eyes, BesideTheOneOfTheCameraAreAWarning) {
  Job job = squares_for_an_eye();
  job.encode.iterations = 1;
  const auto warning_from = [&](double x) {
    job.camera.eye.x = x;
    Heard heard;
    trace_targets(job, heard.observer());
    return heard.warnings.empty() ? "" : heard.warnings.front();
  };
  EXPECT_EQ(warning_from(1e-4 + 0.55e-3), "");
  EXPECT_TRUE(warning_from(1e-4 + 0.65e-3).starts_with("the camera's eye at 750 µm, -50 µm is beside the eyebox"))
      << warning_from(1e-4 + 0.65e-3);
}

// Views of all eyes are denoised and blurred one after the other: each eye keeps its own.
TEST(Eyes, EachHasItsOwnLight) {
  Job job = squares_for_an_eye();
  job.encode.denoise = Denoise::none;
  job.render.paths = 1;
  const Vec3 first = eyes_of(job.encode).front(), second = first + Vec3{1e-3, 0, 0};
  const auto lights = [&](const std::vector<double>& eyes) {
    job.encode.eye = eyes;
    return trace_targets(job).eyes->lights.front().lights;
  };
  const std::vector<LightField> both = lights({first.x, first.y, first.z, second.x, second.y, second.z}),
                                one = lights({first.x, first.y, first.z}),
                                other = lights({second.x, second.y, second.z});
  ASSERT_EQ(both.size(), 2u);
  for (size_t k = 0; k < one[0].views.size(); ++k) EXPECT_EQ(both[0].views[k].values, one[0].views[k].values) << k;
  for (size_t k = 0; k < other[0].views.size(); ++k) EXPECT_EQ(both[1].views[k].values, other[0].views[k].values) << k;
  EXPECT_NE(one[0].views[0].values, other[0].views[0].values);
}

// (w + D)(h + D)/D² of a pupil of 0.5 mm: 3.24, 4 and 6.25, of which 15·log10(4/2.8) = 2.3 dB and 5.2 dB.
TEST(Eyes, AWideEyeboxIsAWarning) {
  Job job = squares_for_an_eye();
  job.encode.iterations = 1;
  const auto warning_for = [&](const std::string& box) {
    job.encode.eyebox = {box};
    Heard heard;
    trace_targets(job, heard.observer());
    return heard.warnings.empty() ? "" : heard.warnings.front();
  };
  EXPECT_EQ(warning_for("0.4 mm"), "");
  EXPECT_TRUE(warning_for("0.5 mm").starts_with(
      "the eyebox of 500 µm × 500 µm is wide for a pupil of 500 µm: from its edge the picture is about 2 dB worse"))
      << warning_for("0.5 mm");
  EXPECT_NE(warning_for("0.75 mm").find("about 5 dB worse"), std::string::npos) << warning_for("0.75 mm");
}

TEST(Eyes, SeeAPictureThatFramesForAllPlacesDoNotShowThem) {
  Job job = squares_for_an_eye();
  job.encode.iterations = 60;
  job.trace.frames = 1;
  const RunResults results = run(job);
  const double for_eye = fact_of(results.report, "look", "psnr_db");
  ASSERT_EQ(results.views_beside.size(), 1u);
  for (const StageReport& stage : results.report.stages)  // that it is outside of the light is its purpose
    if (stage.stage == "look from beside the eyebox") {
      EXPECT_TRUE(stage.warnings.empty()) << stage.warnings.front();
    }
  const auto light_of = [](const Image& view) { return std::accumulate(view.values.begin(), view.values.end(), 0.0); };
  EXPECT_LT(light_of(results.views_beside[0]), 0.5 * light_of(results.views[0]));
  job.encode.eye = {};
  job.encode.planes = 5;
  EXPECT_GT(for_eye, fact_of(run(job).report, "look", "psnr_db") + 6);  // half of the error in amplitude, or less
}

// The light of places around an eye reaches 0.1 mm + 0.5/12 mm + 0.25 mm = 0.392 mm to each side. Two such squares 0.5 mm apart, seen
// one by one, are as much as 2·0.783² mm²; both in one box are (0.783 + 0.5)·0.783 mm².
TEST(EyeWalk, IsTheBoxOfItsPlacesIfThatHasNotMoreLight) {
  Job job = squares_for_an_eye();
  const auto walk = walk_through({{0, 1e-4, 0.02}, {5e-4, 0, 0.02}}, job);
  ASSERT_TRUE(walk);
  EXPECT_EQ(walk->low, (Vec3{0, 0, 0.02}));
  EXPECT_EQ(walk->high, (Vec3{5e-4, 1e-4, 0.02}));
  EXPECT_FALSE(walk_through({{0, 0, 0.02}, {8e-4, 0, 0.02}}, job));  // 1.583 mm > 2·0.783 mm
  EXPECT_TRUE(walk_through({{0, 0, 0.02}, {7.5e-4, 0, 0.02}}, job));
  EXPECT_TRUE(walk_through({{0, 0, 0.0215}, {1e-4, 0, 0.02}}, job));
  EXPECT_FALSE(walk_through({{0, 0, 0.02}, {1e-4, 0, 0.0221}}, job)) << "1.105 times as far";
  EXPECT_FALSE(walk_through({}, job));
  job.last_key = 1;
  EXPECT_FALSE(walk_through({{0, 1e-4, 0.02}, {5e-4, 0, 0.02}}, job)) << "of a scene that moves";
}

// Light of a walk serves each of its places, and that of a place only this one. Of a wall that sends the same light everywhere the views
// are those of light that is traced for the place alone.
TEST(EyeWalk, ItsLightIsThatOfEachPlace) {
  Job job = squares_for_an_eye();
  job.scene.meshes.resize(1);
  job.scene.meshes.front().positions = {
      {-5e-3, -5e-3, -0.02}, {5e-3, -5e-3, -0.02}, {5e-3, 5e-3, -0.02}, {-5e-3, 5e-3, -0.02}};
  job.render.paths = 8;
  const auto at = [&](double x, double z = 0.02) {
    Job moved = job;
    moved.encode.eye = {x, 0, z};
    moved.camera.eye = {x, 0, z};
    moved.chosen = {{"encode.eye", std::to_string(x), ""}};
    return moved;
  };
  const EyeWalk walk{{-2e-4, 0, 0.02}, {3e-4, 0, 0.0215}};
  const SceneTargets first = trace_targets(at(-2e-4), {}, {nullptr, walk});
  // A ray from the panel's edge to that of the places at 21.5 mm crosses the plane at 20 mm at t = 20/21.5 of the one and 1 − t of the
  // other. On the left that is farther out, 0.595 mm, than the places in the plane itself, 0.592 mm; on the right these are: 0.692 mm.
  const LightField& light_of_walk = first.eyes->lights.front().lights.front();
  const double t = 20 / 21.5, half = 1e-4 + 5e-4 / 12 + 2.5e-4, edge = job.slm.grid.width() / 2;
  EXPECT_EQ(light_of_walk.lens_z, 0.02);
  EXPECT_NEAR(light_of_walk.lens.centre_x, (3e-4 + half - t * (2e-4 + half) - (1 - t) * edge) / 2, 1e-12);
  for (const auto& [x, z] : {std::pair(-2e-4, 0.02), {0.0, 0.0207}, {3e-4, 0.0215}, {-2e-4, 0.0215}}) {
    const Job here = at(x, z);
    const SceneTargets again = trace_targets(here, {}, {first.eyes, walk}), alone = trace_targets(here);
    EXPECT_EQ(again.eyes, first.eyes) << x;
    EXPECT_EQ(again.distances, alone.distances);
    const ViewTargets seen = targets_of(again, here, {test_wavelength}).views.front();
    const ViewTargets expected = targets_of(alone, here, {test_wavelength}).views.front();
    EXPECT_EQ(seen.picture, expected.picture);
    ASSERT_EQ(seen.amplitudes.front().size(), expected.amplitudes.front().size());
    const auto& all = expected.amplitudes.front().values;
    const double most = *std::max_element(all.begin(), all.end());
    for (size_t i = 0; i < all.size(); ++i) {
      // A cell is a third of a pupil wide. Where the panel's edge cuts it, its light counts in proportion to its width; but the part of
      // a disc beyond −2/3 radii is 0.110, not 0.146. A corner has two edges: 0.08. Nothing is cut in the middle.
      const double light = std::pow(seen.amplitudes.front().values[i] / most, 2), whole = std::pow(all[i] / most, 2);
      ASSERT_NEAR(light, whole, whole > 0.99 ? 0.02 : 0.08) << x << " " << z << " " << i;
    }
    EXPECT_GT(most, 0);
  }
  EXPECT_NE(trace_targets(at(5e-4), {}, {first.eyes, walk}).eyes, first.eyes) << "beyond the walk";
  EXPECT_NE(trace_targets(at(0, 0.0199), {}, {first.eyes, walk}).eyes, first.eyes) << "nearer than the walk";
  Job other = at(0);
  other.scene.materials.front() = Material{};
  EXPECT_NE(trace_targets(other, {}, {first.eyes, walk}).eyes, first.eyes) << "another scene";
  const SceneTargets still = trace_targets(at(0));
  EXPECT_EQ(trace_targets(at(0), {}, {still.eyes, {}}).eyes, still.eyes) << "an eye that rests";
  EXPECT_NE(trace_targets(at(1e-5), {}, {still.eyes, {}}).eyes, still.eyes);
  EXPECT_NE(trace_targets(at(0, 0.0201), {}, {still.eyes, {}}).eyes, still.eyes);
  EXPECT_NE(trace_targets(at(1e-5), {}, {still.eyes, walk}).eyes, still.eyes)
      << "light of one place is not that of a walk";
}

TEST(Eyes, OfSeveralEachGetsItsPicture) {
  Job job = two_squares();
  job.encode.eye = {-4e-4, 0, 0.02, 4e-4, 0, 0.02};
  job.encode.pupil = 3e-4;
  job.encode.eyebox = {"0.1 mm"};
  job.trace.frames = 2;
  const SceneTargets targets = trace_targets(with_eyes(job));
  ASSERT_EQ(targets.eyes->lights.front().lights.size(), 2u);
  for (const double x : {-4e-4, 4e-4}) {
    job.camera.eye = {x, 0, 0.02};
    job.encode.iterations = 1;
    const double before = fact_of(run(with_eyes(job)).report, "look", "psnr_db");
    job.encode.iterations = 60;
    EXPECT_GT(fact_of(run(with_eyes(job)).report, "look", "psnr_db"), before + 6) << x;
  }
}

// A square of side 0.3 mm about x = −0.2 mm, 5 mm in front of the panel, before an eye that is 20 mm in front of the panel: in the
// plane of the square the picture is where the square is. The rays from all of the pupil through the square are in the panel's
// acceptance: 0.4 mm in 15 mm is a sine of 0.027, the panel's is 0.033.
TEST(Eyes, SeeWhatIsInFrontOfThePanel) {
  Job job = squares_for_an_eye();
  job.encode.eye = {-2e-4, 0, 0.02};
  job = with_eyes(job);
  for (Vec3& p : job.scene.meshes.front().positions) p.z = 5e-3;
  job.scene.meshes.resize(1);
  job.camera.distances = {-5e-3};
  const auto kept = trace_targets(job).eyes;
  const ViewTargets view =
      view_of_eye({-2e-4, 0, 0.02}, kept->lights.front().lights.front(), job, -5e-3, test_wavelength);
  EXPECT_EQ(view.z, 5e-3);
  double sum = 0, x = 0, y = 0, wide = 0;
  for (int j = 0; j < view.picture.ny; ++j)
    for (int i = 0; i < view.picture.nx; ++i) {
      const double power = std::pow(view.amplitudes.front()(j, i), 2);
      sum += power;
      x += power * view.picture.x(i);
      y += power * view.picture.y(double(j));
      wide += power * std::pow(view.picture.x(i) + 2e-4, 2);
    }
  ASSERT_GT(sum, 0);
  EXPECT_NEAR(x / sum, -2e-4, 5e-6);
  EXPECT_NEAR(y / sum, 0, 5e-6);
  // The pupil blurs by λs/D = 16 µm: 8 to 10 % of the side's moment, side²/12, for the moment of an Airy disc grows with the
  // window around it.
  EXPECT_NEAR(wide / sum, std::pow(3e-4, 2) / 12, 0.12 * std::pow(3e-4, 2) / 12);
}

TEST(Eyes, MustBeWhereLightOfThePanelComes) {
  const auto error = [](std::vector<double> eye, std::vector<std::string> box) {
    Job job = two_squares();
    job.encode.eye = std::move(eye);
    job.encode.eyebox = std::move(box);
    try {
      check_job(job);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(error({0, 0, 0.25}, {}), "");
  EXPECT_TRUE(
      error({0, 0, -0.25}, {}).starts_with("expected an eye in front of the panel (z above 0 m), got z = -250 mm"));
  EXPECT_TRUE(error({0, 0}, {}).starts_with("expected x, y and z of each eye"));
  // Half the panel, 0.64 mm, and 250 mm·tan(asin(λ/2p)) = 8.32 mm.
  EXPECT_TRUE(error({0.02, 0, 0.25}, {}).starts_with("expected an eye that light of the panel reaches, at most 8.95"))
      << error({0.02, 0, 0.25}, {});
  EXPECT_TRUE(error({0, 0, 0.25}, {"30 mm"}).starts_with("expected an eyebox that light of the panel reaches"));
  // 1.22·λ·1.2 m/3 mm = 0.26 mm, more than a quarter of the panel's height of 0.96 mm; from 1.1 m it is 0.238 mm.
  EXPECT_TRUE(error({0, 0, 1.2}, {}).starts_with("expected an eye that sees detail on the panel, got one at 1.2 m"));
  EXPECT_EQ(error({0, 0, 1.1}, {}), "");
  EXPECT_TRUE(error({0, 0, 0.25}, {"wide"}).find("wide") != std::string::npos);
  EXPECT_TRUE(error({}, {"wide"}).find("wide") != std::string::npos) << "also without an eye";
  EXPECT_TRUE(error({0, 0, 0.25}, {"1 2 3 mm"}).starts_with("expected a diameter, a width and a height, or \"all\""));
}

double light_in(const std::vector<Image>& pictures) {
  double sum = 0;
  for (const Image& picture : pictures)
    for (const float value : picture.values) sum += double(value);
  return sum;
}

// A square that is there for a quarter of the exposure has a quarter of its light, in all that holograms aim at and are compared with.
// Paths are shared among the moments: lamps that are seen have no other noise.
TEST(SceneTargets, AreTheMeanOfAnOpenShutter) {
  const auto expect_mean = [](const Job& still, const std::function<double(const Job&)>& light) {
    Job first = still, moving = still;
    first.scene.meshes.pop_back();  // planes are named, so that all have the same
    const auto both = std::make_shared<Scene>(still.scene), one = std::make_shared<Scene>(first.scene);
    for (int k = 0; k < 8; ++k) moving.moments.push_back({k < 6 ? one : both, {}});
    const double all = light(still), without = light(first);
    EXPECT_GT(all, 1.2 * without);
    EXPECT_NEAR(light(moving), without + 0.25 * (all - without), 0.01 * all);
  };
  Job planes = two_squares();
  planes.encode.target_distances = {0.02, 0.024};
  planes.render.columns = 80, planes.render.rows = 60;
  expect_mean(planes, [](const Job& job) { return light_in(trace_targets(job).planes.pictures); });
  expect_mean(planes, [](const Job& job) { return light_in({make_render(job, job.render)}); });
  expect_mean(planes, [](const Job& job) { return light_in({make_halved_render(job, job.render).mean}); });
  expect_mean(planes, [](const Job& job) {
    return light_in(make_focal_stack(job, {0.02, 0.024}, job.render, PictureUse::radiance).pictures);
  });
  Job eye = squares_for_an_eye();
  eye.encode.target_distances = {0.02, 0.024};
  expect_mean(eye, [](const Job& job) { return light_in(trace_targets(job).eyes->lights.at(0).lights.at(0).views); });
}

// What moves is in the range of depths as long as the shutter is open, to its last moment.
TEST(SceneTargets, PlanesGoThroughAllMomentsOfAnOpenShutter) {
  Job job = two_squares();
  const std::vector<double> whole = target_distances_of(job);
  Job first = job;
  first.scene.meshes.pop_back();
  EXPECT_LT(target_distances_of(first).back(), whole.back() - 1e-3);
  const auto both = std::make_shared<Scene>(job.scene), one = std::make_shared<Scene>(first.scene);
  first.moments = {{one, {}}, {one, {}}, {both, {}}};
  EXPECT_EQ(target_distances_of(first), whole);
}

TEST(SceneTargets, ALightFieldNeedsAVirtualImageAndOneSamplePerPixel) {
  Job job = two_squares();
  job.encode.target = EncodeTarget::light_field;
  EXPECT_NO_THROW(check_job(job));
  job.encode.subpixels = 3;
  EXPECT_THROW(check_job(job), Error);
  job.encode.subpixels = 1;
  job.encode.image = ImageSide::real_image;
  EXPECT_THROW(check_job(job), Error);
}

TEST(SceneTargets, NeedGradientDescent) {
  Job job = two_squares();
  EXPECT_NO_THROW(check_job(job));
  job.encode.method = Encoding::phase;
  EXPECT_THROW(check_job(job), Error);
}

TEST(SceneTargets, RefuseStacksOfAnotherPanel) {
  FocalStack stack{{8, 6, 8e-6}, {0.3}, {Image(6, 8, 1)}};
  const auto error = [&](const Grid& panel) {
    try {
      targets_of_stack(stack, panel, test_wavelength, ImageSide::virtual_image);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(error({8, 6, 8e-6}), "");
  EXPECT_NE(error({10, 6, 8e-6}).find("expected a focal stack of 10 × 6 pixels, as many as the panel has, got 8 × 6"),
            std::string::npos);
  EXPECT_NE(error({8, 6, 4e-6}).find("expected a focal stack with the panel's pitch 4 µm, got 8 µm"), std::string::npos)
      << error({8, 6, 4e-6});
}

// All views show a bright square of side s in their plane at D. In a plane at d, the ray from a place a of the panel through the middle
// meets it where |a|·|1 − D/d| ≤ s/2: a quarter of the panel, here, and so a quarter of the radiance.
TEST(SceneTargets, PlanesOfALightFieldHaveTheLightOfTheWholePanel) {
  Job job;
  job.slm.grid = {64, 64, 8e-6};
  job.wavelengths = {532e-9};
  LightField light{.panel = job.slm.grid,
                   .lens = {16, 16, 32e-6},
                   .lens_z = 0,
                   .columns = 16,
                   .rows = 16,
                   .plane = {200, 200, 4e-6},
                   .distance = 0.3,
                   .views = {}};
  Image view(200, 200, 1);
  for (int row = 0; row < 200; ++row)
    for (int column = 0; column < 200; ++column)
      view(row, column) = std::max(std::abs(row - 99.5), std::abs(column - 99.5)) < 16 ? 3.0F : 0.0F;  // s = 128 um
  light.views.assign(256, view);
  const FocalStack stack = planes_of(light, job, {0.2, 0.3});
  EXPECT_EQ(stack.distances, (std::vector<double>{0.2, 0.3}));
  EXPECT_NEAR(stack.pictures[0](31, 31), 3.0 / 4, 0.02);
  EXPECT_NEAR(stack.pictures[1](31, 31), 3.0, 1e-4) << "in the plane of the views; 256 roundings of float";
  EXPECT_EQ(stack.pictures[1](31, 60), 0);
}

}  // namespace
}  // namespace holotrace
