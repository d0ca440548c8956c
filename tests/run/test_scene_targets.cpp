#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/run/pipeline.h"
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

TEST(SceneTargets, PlanesGoThroughTheDepthOfTheScene) {
  Job job = two_squares();
  job.encode.planes = 3;
  const std::vector<double> distances = target_distances_of(job);
  ASSERT_EQ(distances.size(), 3u);
  EXPECT_NEAR(distances[0], 0.02, 1e-9);
  EXPECT_NEAR(distances[2], 0.024, 1e-9);
  EXPECT_NEAR(1 / distances[1], (1 / 0.02 + 1 / 0.024) / 2, 1e-6);  // evenly spaced in 1/distance
  // The squares are 8.33/m apart in 1/distance; a depth of focus is 2λ/w² with w = 1.28 mm, 0.649/m: 13 steps, 14 planes.
  job.encode.planes = 100;
  EXPECT_EQ(target_distances_of(job).size(), 14u);
  job.encode.target_distances = {0.021};
  EXPECT_EQ(target_distances_of(job), (std::vector<double>{0.021}));
  job.encode.target_distances = {};
  job.scene = {};
  EXPECT_THROW(target_distances_of(job), Error);
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
  // The surfaces, at 20 and 30 mm, are 16.7/m apart: 26 steps of 0.649/m (as above), 27 planes. All of the image is in one plane.
  ASSERT_EQ(distances.size(), 28u);
  EXPECT_NEAR(distances.front(), 0.02, 1e-6);
  EXPECT_NEAR(distances[26], 0.03, 1e-6);
  EXPECT_NEAR(distances.back(), 0.04, 1e-6);
  job.encode.planes = 4;
  const std::vector<double> few = target_distances_of(job);
  ASSERT_EQ(few.size(), 4u);
  EXPECT_NEAR(few[2], 0.03, 1e-6);
  EXPECT_NEAR(few.back(), 0.04, 1e-6);
  job.encode.planes = 1;  // in the middle of all, in 1/distance
  EXPECT_NEAR(target_distances_of(job).front(), 2 / (1 / 0.02 + 1 / 0.04), 1e-6);
  job.scene.materials[1].surface = DiffuseMaterial{};  // without a mirror there is no image
  job.encode.planes = 100;
  EXPECT_EQ(target_distances_of(job).size(), 27u);
}

TEST(SceneTargets, AmplitudeIsTheRootOfTheRadiance) {
  Job job = two_squares();
  job.encode.target_distances = {0.02, 0.024};
  const SceneTargets targets = trace_targets(job);
  const TargetSet set = targets_of(targets, job, {test_wavelength});
  ASSERT_EQ(set.planes.size(), 2u);
  EXPECT_EQ(set.planes[0].z, -0.02);
  EXPECT_FALSE(set.draw_views);
  // In the middle of the near square, 19 pixels from its edges, there is its radiance of 1 but for the light that the
  // aperture diffracts beyond the edges: 1/(2π²·19·c) of each of four edges, c = w/λd = 0.98 cycles per pixel: 1 %.
  const Grid& grid = job.slm.grid;
  const int column = int(std::lround((-2e-4 - grid.x(0)) / grid.pitch));
  EXPECT_NEAR(set.planes[0].amplitude(60, column), 1, 0.02);
  EXPECT_LT(set.planes[0].amplitude(5, column), 0.1);  // above the square
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
  const TargetPlane view = view_target(targets, job, {{0, 0, 0.3}, 2e-3}, 0.02, test_wavelength);
  const Grid& grid = job.slm.grid;
  const int column = int(std::lround((-2e-4 - grid.x(0)) / grid.pitch));
  EXPECT_NEAR(std::pow(view.amplitude(60, column), 2), 0.0100 * 0.93, 0.0007);
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
  const Boxes boxes = run(job);
  for (const Hologram& hologram : boxes.holograms) EXPECT_FALSE(hologram.loses_by_cone || hologram.loses_by_pixels);
  const Image& view = boxes.views.front();
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
  const Boxes boxes = run(job);
  EXPECT_EQ(boxes.holograms.size(), 4u);
  EXPECT_TRUE(boxes.sources.empty());
  EXPECT_TRUE(boxes.fields.empty());
  EXPECT_EQ(boxes.report.stages.front().stage, "focal stack");
  const auto psnr = [](const Boxes& shown) {  // of the view
    for (const StageReport& stage : shown.report.stages)
      for (const auto& [name, value] : stage.facts)
        if (stage.stage.starts_with("look") && name == "psnr_db") return std::get<double>(value);
    return 0.0;
  };
  job.encode.iterations = 1;                   // random phases
  EXPECT_GT(psnr(boxes), psnr(run(job)) + 5);  // a third of the error, or less
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
  const Boxes boxes = run(job);
  ASSERT_EQ(boxes.holograms.size(), 2u);
  for (const Hologram& hologram : boxes.holograms) {
    ASSERT_EQ(hologram.colours.size(), 2u);
    EXPECT_EQ(hologram.colours[1].wavelength, 633e-9);
    EXPECT_EQ(hologram.colours[0].illumination, hologram.illumination);
    EXPECT_GT(hologram.colours[1].illumination, 0);
  }
  EXPECT_EQ(boxes.views.front().channels, 3);
  job.encode.iterations = 1;
  const double before = fact_of(run(job).report, "look", "psnr_db");
  EXPECT_GT(fact_of(boxes.report, "look", "psnr_db"), before + 3);  // half the error, or less
  job.encode.target = EncodeTarget::field;
  EXPECT_THROW(check_job(job), Error);
}

// A light field of the squares, for an eye with a pupil of 0.5 mm.
Job squares_for_an_eye() {
  Job job = two_squares();
  job.encode.target = EncodeTarget::light_field;
  job.encode.planes = 2;
  job.trace.frames = 2;
  job.camera.eye = {1e-4, -5e-5, 0.02};
  job.camera.pupil = 5e-4;
  return job;
}

// How near the mean of the frames is to the traced picture through the camera's pupil.
double psnr_through_pupil(const std::vector<Hologram>& frames, const SceneTargets& targets, const Job& job,
                          double wavelength) {
  Image seen;
  for (const Hologram& frame : frames) {
    const Image view = look(show(frame, job.slm, {.wavelength = wavelength}), job.slm, 0.02, {}, job.camera);
    if (seen.values.empty()) seen = Image(view.ny, view.nx, 1);
    for (size_t i = 0; i < seen.values.size(); ++i) seen.values[i] += view.values[i];
  }
  const TargetPlane target = view_target(targets, job, {job.camera.eye, job.camera.pupil}, 0.02, wavelength);
  Image wanted(seen.ny, seen.nx, 1);
  EXPECT_EQ(wanted.values.size(), target.amplitude.size());
  for (size_t i = 0; i < wanted.values.size(); ++i) wanted.values[i] = std::pow(target.amplitude.values[i], 2);
  return compare(wanted, seen).psnr;
}

// The pupil is no target; the picture through it is nearer to the traced one than that of the first frames, in each colour.
TEST(SceneTargets, JointLightFieldsShowBothColoursThroughAPupil) {
  Job job = squares_for_an_eye();
  job.wavelengths = {test_wavelength, 633e-9};
  job.encode.is_joint = true;
  job.slm.phase_range = 4 * pi;
  const SceneTargets targets = trace_targets(job);
  const auto frames_after = [&](int updates) {
    job.encode.iterations = updates;
    return run(job).holograms;
  };
  const std::vector<Hologram> first = frames_after(1), last = frames_after(20);
  for (const double wavelength : job.wavelengths)
    EXPECT_GT(psnr_through_pupil(last, targets, job, wavelength),
              psnr_through_pupil(first, targets, job, wavelength) + 2);
}

TEST(SceneTargets, AViewThroughAPupilIsComparedWithThePictureThroughIt) {
  Job job = squares_for_an_eye();
  job.encode.iterations = 10;
  const Boxes boxes = run(job);
  // Both compare the same pictures, up to the rounding of floats; that of the whole panel would be darker and sharper.
  EXPECT_NEAR(fact_of(boxes.report, "look", "psnr_db"),
              psnr_through_pupil(boxes.holograms, trace_targets(job), job, test_wavelength), 0.01);
  // The target render knows the picture through the whole panel alone.
  job.encode.target = EncodeTarget::render;
  for (const StageReport& stage : run(job).report.stages)
    for (const auto& [name, value] : stage.facts) EXPECT_FALSE(stage.stage.starts_with("look") && name == "psnr_db");
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

}  // namespace
}  // namespace holotrace
