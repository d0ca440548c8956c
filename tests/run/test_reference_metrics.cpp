// What a report says of a view with a quick reference.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <variant>

#include "holotrace/data/shapes.h"
#include "holotrace/run/reference_metrics.h"
#include "holotrace/run/renders.h"
#include "holotrace/view/compare.h"

namespace holotrace::test {
namespace {

// A ramp from 0.2 to 1 with noise of zero mean and that standard deviation. (A sum of 12 uniform numbers less 6 is normal
// to the fourth moment but for 0.1.)
Image noisy_ramp(double sigma, uint32_t seed) {
  Image image(128, 128, 1);
  uint32_t state = seed * 2654435761U + 1;
  for (int j = 0; j < image.ny; ++j)
    for (int i = 0; i < image.nx; ++i) {
      double sum = -6;
      for (int k = 0; k < 12; ++k) {
        state = state * 1664525U + 1013904223U;
        sum += (state >> 8) / 16777216.0;
      }
      image(j, i) = float(0.2 + 0.8 * i / 127 + sigma * sum);
    }
  return image;
}

std::map<std::string, double> facts_of(const ViewReference& reference, const Image& view) {
  std::map<std::string, double> facts;
  Observer observer;
  observer.on_fact = [&](const std::string& name, const Fact& value) {
    facts[name] = std::holds_alternative<double>(value) ? std::get<double>(value) : 0;
  };
  report_metrics(reference, view, 0.5, observer);
  return facts;
}

Image mean_of(const Image& a, const Image& b) {
  Image mean = a;
  for (size_t i = 0; i < a.values.size(); ++i) mean.values[i] = (a.values[i] + b.values[i]) / 2;
  return mean;
}

// The view is off by 0.05 rms. Noise of 0.04 per half is 0.028 in the mean, which alone would cost 1.2 dB.
TEST(QuickReference, PsnrIsThatOfAFullReferenceWithinItsUncertainty) {
  const Image view = noisy_ramp(0.05, 1);
  const double full = compare(noisy_ramp(0.04 / std::sqrt(8.0), 2), view).psnr;  // 8 times the paths of a half
  const Image first = noisy_ramp(0.04, 3), mean = mean_of(first, noisy_ramp(0.04, 4));
  const auto facts = facts_of({mean, mean, first, 0.25}, view);
  EXPECT_NEAR(facts.at("psnr_db"), full, facts.at("psnr_uncertainty_db"));
  EXPECT_LT(facts.at("psnr_uncertainty_db"), 1);
  EXPECT_EQ(facts.at("diffraction_efficiency"), 0.5 * facts.at("bright_fraction"));
}

// With the maximum of the reference kept fixed by one bright pixel, only the error is left: 0.1 dB is 1.2 % of it.
TEST(QuickReference, TakesTheNoiseOutOfTheError) {
  Image view = noisy_ramp(0.05, 1), truth = noisy_ramp(0, 0), first = noisy_ramp(0.04, 3), second = noisy_ramp(0.04, 4);
  for (Image* image : {&view, &truth, &first, &second}) (*image)(64, 64) = 2;
  const auto facts = facts_of({truth, mean_of(first, second), first, 0}, view);  // a full reference without noise
  EXPECT_NEAR(facts.at("psnr_db"), compare(truth, view).psnr, 0.1);
}

// Where the reference is flat, its noise counts as structure that the view lacks: without the correction SSIM is 0.16 lower.
TEST(QuickReference, TakesTheNoiseOutOfTheStructuralSimilarity) {
  Image view = noisy_ramp(0.01, 1), truth = noisy_ramp(0, 0), first = noisy_ramp(0.04, 3), second = noisy_ramp(0.04, 4);
  for (Image* image : {&view, &truth, &first, &second}) (*image)(64, 64) = 2;
  const Image mean = mean_of(first, second);
  const double ssim = compare(truth, view).ssim;
  EXPECT_LT(compare(mean, view).ssim, ssim - 0.1);
  // A window knows its noise to a fifth, as it has some 30 effective pixels; the curvature of the ratio leaves 0.013.
  EXPECT_NEAR(facts_of({truth, mean, first, 0}, view).at("ssim"), ssim, 0.02);
}

// A full reference has noise, too, a quarter of the mean's variance, which stays: taking it out would raise SSIM by 0.03.
TEST(QuickReference, LeavesTheNoiseOfAFullReferenceInTheStructuralSimilarity) {
  Image view = noisy_ramp(0.01, 1), truth = noisy_ramp(0, 0), first = noisy_ramp(0.04, 3), second = noisy_ramp(0.04, 4);
  Image full = noisy_ramp(0.04 / std::sqrt(8.0), 2);
  for (Image* image : {&view, &truth, &first, &second, &full}) (*image)(64, 64) = 2;
  const Image mean = mean_of(first, second);
  const double ssim = facts_of({truth, mean, first, 0.25}, view).at("ssim");
  EXPECT_NEAR(ssim, compare(full, view).ssim, 0.01);  // as above, and less is taken out
  EXPECT_LT(ssim, facts_of({truth, mean, first, 0}, view).at("ssim") - 0.02);
}

// Noise of 0.028 in the mean, whose light is 0.2 to 1, raises the contrast by a seventh and lowers the uniformity by a
// twentieth. Fourth moments of the noise leave a quarter of that in the dark parts.
TEST(QuickReference, TakesTheNoiseOutOfTheMetricsOfTheBrightRegion) {
  const Image truth = noisy_ramp(0, 0), first = noisy_ramp(0.04, 3), second = noisy_ramp(0.04, 4);
  const Image view = noisy_ramp(0.05, 1), mean = mean_of(first, second);
  const BrightMetrics expected = compare(truth, view), of_mean = compare(mean, view);
  const auto facts = facts_of({truth, mean, first, 0}, view);
  EXPECT_NEAR(facts.at("speckle_contrast"), expected.speckle_contrast, 0.005);
  EXPECT_GT(of_mean.speckle_contrast, expected.speckle_contrast + 0.015);
  EXPECT_NEAR(facts.at("uniformity"), expected.uniformity, 0.006);
  EXPECT_LT(of_mean.uniformity, expected.uniformity - 0.03);
}

// A full reference has noise, too: all of the mean's, if it has as many paths; half of its variance, if it has twice as many.
TEST(QuickReference, LeavesTheNoiseOfAFullReferenceInTheMetricsOfTheBrightRegion) {
  Image truth = noisy_ramp(0, 0), first = noisy_ramp(0.04, 3), second = noisy_ramp(0.04, 4), view = noisy_ramp(0.05, 1);
  for (Image* image : {&truth, &first, &second, &view})
    for (float& value : image->values) value -= 0.15F;  // so that a part of the ramp is not bright
  const Image mean = mean_of(first, second);
  const BrightMetrics of_mean = compare_bright(mean, view, 0.085);
  const std::map<std::string, double> of_mean_by_name = {{"speckle_contrast", std::pow(of_mean.speckle_contrast, 2)},
                                                         {"bright_fraction", of_mean.bright_fraction},
                                                         {"uniformity", of_mean.uniformity}};
  for (const auto& [name, expected] : of_mean_by_name) {
    const auto found = [&, name = name](double part) {
      const double fact = facts_of({truth, mean, first, part}, view).at(name);
      return name == "speckle_contrast" ? fact * fact : fact;
    };
    EXPECT_NEAR(found(1), expected, 1e-9) << name;
    EXPECT_NE(found(0), expected) << name;
    EXPECT_NEAR(found(0.5), (found(0) + found(1)) / 2, 1e-9) << name;
  }
}

// One path of a half found the lamp, none of the other: then the mean alone says what is bright. If the full paths of the
// brightest pixels are brighter than ten times the mean, nothing in the mean is bright; without their light, nothing is known.
TEST(QuickReference, OfRarePathsHasFiniteMetrics) {
  const Image nothing(128, 128, 1), view = noisy_ramp(0.05, 1);
  Image first(128, 128, 1), mean(128, 128, 1), image(128, 128, 1);
  first(64, 64) = 1;
  mean(64, 64) = 0.5F;
  image(64, 64) = 1;
  const auto one_half = facts_of({image, mean, first, 0.25}, view);
  EXPECT_NEAR(one_half.at("bright_fraction"), compare_bright(mean, view, 0.1).bright_fraction, 1e-12);
  EXPECT_EQ(one_half.at("uniformity"), 1);                               // of one pixel
  const auto other_half = facts_of({image, mean, nothing, 0.25}, view);  // mean − nothing: the second half has the path
  EXPECT_EQ(other_half.at("bright_fraction"), one_half.at("bright_fraction"));
  EXPECT_EQ(compare_bright(mean, view, 2).uniformity, 0);  // of no pixel
  image(64, 64) = 20;
  image(64, 65) = 3;
  const auto far_brighter = facts_of({image, mean, first, 0.25}, view);
  EXPECT_NEAR(far_brighter.at("bright_fraction"), compare_bright(image, view, 2).bright_fraction, 1e-12);
  for (const auto& [name, fact] : far_brighter) EXPECT_TRUE(std::isfinite(fact)) << name;
  EXPECT_EQ(facts_of({nothing, mean, first, 0.25}, view).count("why_no_metrics"), 1U);
  EXPECT_EQ(facts_of({image, nothing, nothing, 0.25}, view).count("why_no_metrics"), 1U);
}

// All pixels near the maximum have all paths, others are noisy: the maximum is certain.
TEST(QuickReference, IsCertainOfAMaximumWithAllPaths) {
  Image reference(16, 16, 1), mean(16, 16, 1), half(16, 16, 1), view(16, 16, 1);
  for (size_t i = 0; i < reference.values.size(); ++i) {
    reference.values[i] = i % 2 == 0 ? 1.0F : 0.6F;
    mean.values[i] = i % 2 == 0 ? 1.2F : 0.6F;
    half.values[i] = i % 2 == 0 ? 1.5F : 0.7F;
    view.values[i] = 0.5F;
  }
  EXPECT_EQ(facts_of({reference, mean, half, 1}, view).at("psnr_uncertainty_db"), 0);
  EXPECT_EQ(facts_of({reference, mean, half, 1}, view).at("ssim_uncertainty"), 0);
  for (size_t i = 1; i < half.values.size(); i += 2) half.values[i] = 0.74F;  // 0.6 + 3·0.14 reaches the maximum
  EXPECT_NEAR(facts_of({reference, mean, half, 1}, view).at("psnr_uncertainty_db"), 20 * std::log10(1.42), 1e-5);
  // SSIM is then also known for the larger maximum alone.
  EXPECT_GT(facts_of({reference, mean, half, 1}, view).at("ssim_uncertainty"), 1e-4);
}

TEST(QuickReference, WithoutNoiseIsTheFullOne) {
  const Image view = noisy_ramp(0.05, 1), truth = noisy_ramp(0, 0);
  const auto quick = facts_of({truth, truth, truth, 0.125}, view), full = facts_of({truth}, view);
  EXPECT_EQ(quick.at("psnr_db"), full.at("psnr_db"));
  EXPECT_EQ(quick.at("psnr_uncertainty_db"), 0);
  EXPECT_EQ(full.at("ssim"), compare(truth, view).ssim);
}

// The half differs by 0.1 where the reference is bright, 1, and by 0.3 where it is dim, 0.3. Only the bright ones count:
// three times their noise over the peak. With all paths in the half there is nothing to take out of the error.
TEST(QuickReference, UncertaintyIsThreeTimesTheNoiseOfBrightPixels) {
  Image reference(16, 16, 1), half(16, 16, 1), view(16, 16, 1);
  for (size_t i = 0; i < reference.values.size(); ++i) {
    reference.values[i] = i % 2 == 0 ? 1.0f : 0.3f;
    half.values[i] = i % 2 == 0 ? 1.1f : 0.6f;
    view.values[i] = 0.5f;
  }
  EXPECT_NEAR(facts_of({reference, reference, half, 1}, view).at("psnr_uncertainty_db"), 20 * std::log10(1.3),
              1e-5);  // floats
}

TEST(QuickReference, SaysWhyThereIsNothingToCompare) {
  EXPECT_EQ(facts_of({Image(8, 8, 1)}, noisy_ramp(0.1, 1)).count("why_no_metrics"), 1U);
}

TEST(QuickReference, HasAQuarterOfThePaths) {
  Job job;
  job.camera.distances = {0.3};
  for (const auto& [paths, expected] : {std::pair{64, 16}, {24, 6}, {15, 4}, {9, 4}, {8, 2}, {2, 2}}) {
    job.render.paths = paths;
    EXPECT_EQ(plan_renders(job).front().params.paths, expected) << paths;
    EXPECT_EQ(is_quick(job), paths > 2) << paths;
  }
}

// A lamp's light falls off across the floor: its brightest pixels are few.
TEST(HalvedRender, TheBrightestPixelsAreThoseOfTheFullRender) {
  Job job;
  job.wavelengths = {532e-9};
  job.slm = {.name = "test", .grid = {64, 64, 8e-6}};
  job.scene.materials = {Material{}};
  Mesh floor = make_quad(20e-3, 20e-3);
  for (Vec3& p : floor.positions) p += Vec3{0, 0, -0.1};
  job.scene.meshes = {floor};
  job.scene.lights = {RectangleLight{{-1e-3, 1e-3, -0.099}, {2e-3, 0, 0}, {0, -2e-3, 0}, {1, 1, 1}, false},
                      PointLight{{1e-3, 1e-3, -0.0995}, {1e-6, 1e-6, 1e-6}}};
  job.render.rows = 64;
  job.render.paths = 64;
  RenderParams few = job.render;
  few.paths = 4;
  const HalvedRender halves = make_halved_render(job, few);
  const Image full = make_render(job, job.render);
  const float peak = *std::max_element(full.values.begin(), full.values.end());
  const Image& image = halves.brightest;
  EXPECT_EQ(*std::max_element(image.values.begin(), image.values.end()), peak);
  size_t equal = 0, replaced = 0;
  for (size_t i = 0; i < full.values.size(); i += 3) {
    equal += image.values[i] == full.values[i];
    replaced += image.values[i] != halves.mean.values[i];
  }
  const size_t pixels = full.values.size() / 3;
  EXPECT_GE(equal, pixels / 50);
  EXPECT_LE(replaced, 2 * (pixels / 50));
}

// Beside a lamp single paths that meet it bring much light: most of the brightest pixels of a quick render are dark in the
// full one.
TEST(HalvedRender, AMaximumOfRarePathsIsThatOfTheFullRender) {
  Job job;
  job.wavelengths = {532e-9};
  job.slm = {.name = "test", .grid = {64, 64, 8e-6}};
  job.scene.materials = {Material{}};
  Mesh floor = make_quad(20e-3, 20e-3), wall = make_quad(20e-3, 20e-3);
  for (Vec3& p : floor.positions) p += Vec3{0, 0, -0.1};
  for (Vec3& p : wall.positions) p = Vec3{4e-3, p.x, -0.095 + p.y};
  job.scene.meshes = {floor, wall};
  job.scene.lights = {RectangleLight{{3.9e-3, -3e-3, -0.0999}, {0, 6e-3, 0}, {0, 0, 4e-3}, {9, 9, 9}, false}};
  job.render.rows = 96;
  job.render.paths = 64;
  RenderParams few = job.render;
  few.paths = 8;
  const auto maximum = [](const Image& image) { return *std::max_element(image.values.begin(), image.values.end()); };
  // Another maximum may be among paths that a quick render has not found. With roulette from surface 1 it is not; from
  // surface 4 it is, and differs by less than 1 dB (a factor of 1.12), which is less than the uncertainty that is told.
  for (const int depth : {1, 4}) {
    job.render.roulette_depth = few.roulette_depth = depth;
    const HalvedRender halves = make_halved_render(job, few);
    const Image full = make_render(job, job.render);
    EXPECT_GT(maximum(halves.mean), 1.2F * maximum(full)) << "else the line below claims little";
    EXPECT_NEAR(maximum(halves.brightest) / maximum(full), 1, depth == 1 ? 0 : 0.12) << depth;
  }
}

// A lamp covers 2 × 2 pixels, and parts of the 12 around them. A fiftieth of the pixels are 8, the brightest ones; the
// other 8 are neighbours of the maximum, which views mix with it.
TEST(HalvedRender, NeighboursOfTheMaximumAreThoseOfTheFullRender) {
  Job job;
  job.wavelengths = {532e-9};
  job.slm = {.name = "test", .grid = {64, 64, 8e-6}};
  Material lamp;
  lamp.emission = {1, 1, 1};
  job.scene.materials = {lamp};
  Mesh quad = make_quad(1e-3, 1e-3);  // three pixels wide
  for (Vec3& p : quad.positions) p += Vec3{1e-4, 1e-4, -0.1};
  job.scene.meshes = {quad};
  job.render.rows = 20;
  job.render.paths = 64;
  RenderParams few = job.render;
  few.paths = 8;
  const HalvedRender halves = make_halved_render(job, few);
  const Image full = make_render(job, job.render);
  EXPECT_EQ(halves.brightest.values, full.values);
  EXPECT_NE(halves.mean.values, full.values);
}

TEST(HalvedRender, TheHalvesAreIndependentAndTheMeanIsTheirMean) {
  // A lamp that covers a part of each pixel at its edges: a pixel of 4 paths is one of 0, ¼ … 1 there, by chance.
  Job job;
  job.wavelengths = {532e-9};
  job.slm = {.name = "test", .grid = {64, 64, 8e-6}};
  Material lamp;
  lamp.emission = {1, 1, 1};
  job.scene.materials = {lamp};
  Mesh quad = make_quad(1e-3, 1e-3);
  for (Vec3& p : quad.positions) p += Vec3{1e-4, 0, -0.1};
  job.scene.meshes = {quad};
  job.render.rows = 24;
  job.render.paths = 8;
  const HalvedRender halves = make_halved_render(job, job.render);
  ASSERT_EQ(halves.first.values.size(), halves.mean.values.size());
  size_t different = 0;
  for (size_t i = 0; i < halves.mean.values.size(); ++i) {
    const float second = 2 * halves.mean.values[i] - halves.first.values[i];
    EXPECT_NEAR(second * 4, std::round(second * 4), 1e-4) << i;  // a mean of 4 paths of 0 or 1
    different += std::abs(second - halves.first.values[i]) > 0.1F;
  }
  EXPECT_GT(different, 5U);
}

}  // namespace
}  // namespace holotrace::test
