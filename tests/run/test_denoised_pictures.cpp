#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/run/renders.h"
#include "holotrace/run/scene_targets.h"
#include "holotrace/trace/render.h"
#include "support/denoiser.h"
#include "support/panels.h"

namespace holotrace {
namespace {

using test::Environment;

int64_t denoised(const Heard& heard) { return std::get<int64_t>(heard.facts.at("denoised")); }

// Even light of light paths, each with exponentially distributed light.
Image even_light(int paths, uint64_t seed) {
  Image image(64, 64, 3);
  for (size_t pixel = 0; pixel < 64 * 64; ++pixel) {
    CounterRandom random(seed, 0, pixel);
    double sum = 0;
    for (int path = 0; path < paths; ++path) sum -= std::log(1 - random.uniform());
    for (size_t channel = 0; channel < 3; ++channel) image.values[3 * pixel + channel] = float(sum / paths);
  }
  return image;
}

// A white corner, 10 mm wide, lit by a lamp from above, 30 mm behind the panel.
Job corner_job() {
  Job job;
  job.wavelengths = {test_wavelength};
  job.slm = make_panel(96, 96);
  job.scene.materials = {DiffuseMaterial{{0.7, 0.5, 0.3}}};
  Mesh back, floor;
  const double h = 5e-3;
  back.positions = {{-h, -h, -0.035}, {h, -h, -0.035}, {h, h, -0.035}, {-h, h, -0.035}};
  floor.positions = {{-h, -2e-4, -0.025}, {h, -2e-4, -0.025}, {h, -2e-4, -0.035}, {-h, -2e-4, -0.035}};
  back.triangles = floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  job.scene.meshes = {back, floor};
  job.scene.lights = {RectangleLight{{-1e-3, 4e-3, -0.031}, {2e-3, 0, 0}, {0, 0, 2e-3}, {9, 9, 9}}};
  job.render.columns = job.render.rows = 96;
  job.render.lens = Lens::panel;
  job.render.focus = 0.033;
  job.render.field_of_view = std::atan(96 * 8e-6 / 2 / 0.033);
  job.render.paths = 8;
  job.encode.method = Encoding::sgd;
  job.encode.target = EncodeTarget::render;
  job.encode.target_distances = job.camera.distances = {0.033};
  return job;
}

Job job_with(Denoise choice) {
  Job job;
  job.encode.denoise = choice;
  return job;
}

Image rendered(const Job& job, const RenderParams& params) {
  return render(job.scene, job.slm.grid, test_wavelength, params);
}

double mean_of(const Image& image, int top, int left, int size) {
  double sum = 0;
  for (int row = top; row < top + size; ++row)
    for (int i = 3 * left; i < 3 * (left + size); ++i) sum += image(row, 0, i);
  return sum / (3.0 * size * size);
}

TEST(DenoisedPictures, AreThoseToLookAtUnlessAllAreAskedFor) {
  HOLOTRACE_NEEDS_DENOISER();
  const Job job = corner_job();
  const Image plain = rendered(job, job.render);
  const auto is_denoised = [&](Denoise choice, PictureUse use) {
    RenderParams params = job.render;
    params.denoise = choice;
    Heard heard;
    const bool differs = make_picture(job, params, use, heard.observer()).values != plain.values;
    EXPECT_EQ(differs, heard.facts.contains("denoised") && denoised(heard) == 1);
    EXPECT_EQ(differs, heard.facts.contains("denoiser"));
    return differs;
  };
  EXPECT_TRUE(is_denoised(Denoise::automatic, PictureUse::to_look_at));
  EXPECT_FALSE(is_denoised(Denoise::automatic, PictureUse::radiance));
  EXPECT_FALSE(is_denoised(Denoise::none, PictureUse::to_look_at));
  EXPECT_TRUE(is_denoised(Denoise::all, PictureUse::radiance));
}

TEST(DenoisedPictures, HaveTheMeansOfConvergedOnes) {
  HOLOTRACE_NEEDS_DENOISER();
  const Job job = corner_job();
  RenderParams many = job.render, other = job.render;
  many.paths = 1024;
  other.seed = 2;
  const Image converged = rendered(job, many), noisy = rendered(job, job.render), second = rendered(job, other);
  const Image denoised = make_picture(job, job.render, PictureUse::to_look_at);
  double before = 0, after = 0;
  for (size_t i = 0; i < converged.values.size(); ++i) {
    before += std::pow(double(noisy.values[i]) - converged.values[i], 2);
    after += std::pow(double(denoised.values[i]) - converged.values[i], 2);
  }
  EXPECT_LT(after, before / 4) << "four times the light paths would not be as near";
  for (int top = 0; top < 96; top += 32)
    for (int left = 0; left < 96; left += 32) {
      // The standard error of the light paths, from the pixels of two pictures: √(Σd²/2)/n.
      double squares = 0;
      for (int row = top; row < top + 32; ++row)
        for (int i = 3 * left; i < 3 * (left + 32); ++i)
          squares += std::pow(double(noisy(row, 0, i)) - second(row, 0, i), 2);
      const double error = std::sqrt(squares / 2 * 3) / (3 * 32 * 32);  // the colours of a pixel vary together
      const double wanted = mean_of(converged, top, left, 32);
      EXPECT_NEAR(mean_of(denoised, top, left, 32), wanted, 0.005 * wanted + 3 * error) << top << " " << left;
    }
}

TEST(DenoisedPictures, AFocalStackIsDenoisedPlaneByPlane) {
  HOLOTRACE_NEEDS_DENOISER();
  const Job job = corner_job();
  RenderParams params = job.render;
  const std::vector<double> distances{0.03, 0.034};
  const FocalStack plain = make_focal_stack(job, distances, params, PictureUse::radiance);
  params.denoise = Denoise::all;
  Heard heard;
  const FocalStack stack = make_focal_stack(job, distances, params, PictureUse::radiance, heard.observer());
  EXPECT_EQ(denoised(heard), 2);
  for (size_t k = 0; k < 2; ++k) EXPECT_NE(stack.pictures[k].values, plain.pictures[k].values) << k;
}

TEST(DenoiseTargets, PlanesAndViewsOfALightFieldAreDenoisedUnlessNoneIsAskedFor) {
  HOLOTRACE_NEEDS_DENOISER();
  for (const Denoise choice : {Denoise::none, Denoise::automatic, Denoise::all}) {
    std::vector<Image> planes{even_light(4, 1), even_light(4, 2)}, cells{even_light(4, 3)};
    const std::vector<Image> planes_before = planes, cells_before = cells;
    Heard heard;
    denoise_targets(job_with(choice), planes, cells, heard.observer());
    for (size_t k = 0; k < 2; ++k) EXPECT_EQ(planes[k].values != planes_before[k].values, choice != Denoise::none) << k;
    EXPECT_EQ(cells[0].values != cells_before[0].values, choice != Denoise::none);
    if (choice == Denoise::none)
      EXPECT_TRUE(heard.facts.empty());
    else
      EXPECT_EQ(denoised(heard), 3);
    EXPECT_TRUE(heard.warnings.empty());
  }
}

// Grey planes are denoised three at a time, as the colours of one picture; the last ones may be fewer. Each keeps its own light.
TEST(DenoiseTargets, GreyPlanesKeepTheirOwnLight) {
  HOLOTRACE_NEEDS_DENOISER();
  for (const int count : {3, 4, 5}) {
    std::vector<Image> planes, none;
    std::vector<double> means;
    for (int k = 0; k < count; ++k) {
      planes.push_back(even_light(8, uint64_t(10 + k)));
      for (float& value : planes.back().values) value *= float(1 + k);
      means.push_back(std::accumulate(planes.back().values.begin(), planes.back().values.end(), 0.0));
    }
    Heard heard;
    denoise_targets(job_with(Denoise::automatic), planes, none, heard.observer());
    EXPECT_EQ(denoised(heard), count);
    for (int k = 0; k < count; ++k) {
      const auto& values = planes[size_t(k)].values;
      // Noise of 8 paths is 35 %. The network takes half of it or more, also where the three differ. Means stay to 0.5 %.
      EXPECT_NEAR(std::accumulate(values.begin(), values.end(), 0.0) / means[size_t(k)], 1, 0.02) << count << " " << k;
      double squares = 0;
      for (const float value : values) squares += std::pow(value / (1.0 + k) - 1, 2);
      EXPECT_LT(std::sqrt(squares / double(values.size())), 0.18) << count << " " << k;
      for (size_t i = 0; i < values.size(); i += 3)
        ASSERT_TRUE(values[i] == values[i + 1] && values[i] == values[i + 2]);
    }
  }
}

TEST(DenoiseTargets, StayAsTheyAreIfTheirNoiseIsSmall) {
  HOLOTRACE_NEEDS_DENOISER();
  // The relative error of a mean of N light paths is 1/√N, half of that for amplitudes. For a PSNR of 42 dB, an error of
  // 1/126, of even light: (126/2)² = 3970 paths. The peak is a little above the mean.
  for (const auto& [paths, choice, is_kept] :
       {std::tuple(1000, Denoise::automatic, false), std::tuple(8000, Denoise::automatic, true),
        std::tuple(8000, Denoise::all, false)}) {
    std::vector<Image> planes{even_light(paths, 1), even_light(paths, 2)}, cells{even_light(4, 3)};
    const std::vector<Image> before = planes;
    Heard heard;
    denoise_targets(job_with(choice), planes, cells, heard.observer());
    EXPECT_EQ(denoised(heard), is_kept ? 1 : 3) << "views of few paths are noisy in any case";
    EXPECT_EQ(heard.facts.contains("why_not_denoised"), is_kept);
    for (size_t k = 0; k < 2; ++k) EXPECT_EQ(planes[k].values == before[k].values, is_kept);
  }
}

TEST(DenoiseTargets, ReferencesOfMetricsStayAsTheyAre) {
  HOLOTRACE_NEEDS_DENOISER();
  Job job = corner_job();
  job.render.paths = 2;
  const SceneTargets denoised = trace_targets(job);
  job.encode.denoise = Denoise::none;
  const SceneTargets plain = trace_targets(job);
  Job other = job;
  other.encode.denoise = Denoise::all;
  EXPECT_EQ(trace_scene_references(job)[0].mean.values, trace_scene_references(other)[0].mean.values);
  EXPECT_EQ(denoised.seen.pictures[0].values, denoised.planes.pictures[0].values) << "to look at";
  EXPECT_EQ(plain.planes.pictures[0].values, plain.seen.pictures[0].values) << "the same plane";
  EXPECT_NE(denoised.planes.pictures[0].values, plain.planes.pictures[0].values);
}

TEST(DenoisedPictures, LuminousPointsAreNoNoise) {
  Job job = corner_job();
  job.scene.points = {{{0, 0, -0.03}}};
  for (const Denoise choice : {Denoise::automatic, Denoise::all}) {
    job.render.denoise = job.encode.denoise = choice;
    Heard heard;
    EXPECT_EQ(make_picture(job, job.render, PictureUse::to_look_at, heard.observer()).values,
              rendered(job, job.render).values);
    EXPECT_EQ(std::get<std::string>(heard.facts.at("why_not_denoised")),
              "the scene has luminous points, which look like noise");
    EXPECT_EQ(heard.warnings.size(), choice == Denoise::all ? 1U : 0U);
    std::vector<Image> planes{even_light(4, 1)}, none;
    denoise_targets(job, planes, none);
    EXPECT_EQ(planes[0].values, even_light(4, 1).values);
  }
}

TEST(DenoisedPictures, ALibraryThatCannotBeUsedIsAWarningAndPicturesStayAsTheyAre) {
  const Environment nowhere("HOLOTRACE_OIDN", "/nowhere");
  const Job job = corner_job();
  Heard heard;
  EXPECT_EQ(make_picture(job, job.render, PictureUse::to_look_at, heard.observer()).values,
            rendered(job, job.render).values);
  EXPECT_EQ(denoised(heard), 0);
  ASSERT_EQ(heard.warnings.size(), 1U);
  const std::string& why = std::get<std::string>(heard.facts.at("why_not_denoised"));
  EXPECT_EQ(heard.warnings[0], "pictures are not denoised: " + why);
  Heard of_targets;
  std::vector<Image> planes{even_light(4, 1)}, none;
  denoise_targets(job_with(Denoise::automatic), planes, none, of_targets.observer());
  EXPECT_EQ(planes[0].values, even_light(4, 1).values);
  EXPECT_EQ(of_targets.warnings, heard.warnings);
}

}  // namespace
}  // namespace holotrace
