#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>

#include "holotrace/base/cycles.h"
#include "holotrace/data/acceptance.h"
#include "holotrace/trace/gather.h"
#include "holotrace/trace/trace.h"
#include "holotrace/trace/waves/source_phase.h"
#include "holotrace/wave/sum_exact.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

const Grid gathered_panel{64, 48, 8e-6};
const std::vector<double> green{green_light};

double mean_intensity(const Field& field) { return power(field) / (double(field.grid.pixels()) * 64e-12); }

// Luminous points on both sides of the panel, and a card 10 mm in front of it that hides from the viewer those that are behind it.
// The points' waves, summed, are what each pixel gathers.
TEST(Gather, PointsOnBothSidesAreThoseOfTheSum) {
  Scene scene;
  scene.materials = {grey(0, 0)};
  scene.meshes = {make_test_quad({0.15_mm, 0, 10_mm}, {0.15_mm, 0, 0}, {0, 1_mm, 0})};
  scene.points = {{{-0.1_mm, 0.05_mm, -15_mm}, 1, 0.3F},
                  {{0.1_mm, -0.1_mm, 20_mm}, 2, 1},     // before the card
                  {{-0.3_mm, 0.1_mm, 8_mm}, 1.5F, 2}};  // beside it
  const TraceParams params{.pixel_samples = 1, .paths = 1, .phase = SourcePhase::constant};
  const Field gathered = gather(scene, gathered_panel, green, params).at(0);
  TraceParams shared = params;
  shared.samples = 1;
  shared.tile_columns = 64, shared.tile_rows = 48;
  shared.strategy = Strategy::tiled;
  const Sources sources = trace(scene, gathered_panel, green_light, shared);
  ASSERT_EQ(sources.waves.size(), 3u);
  const FieldDouble summed = sum_exact(sources, gathered_panel);
  double error = 0, energy = 0;
  for (size_t i = 0; i < summed.samples.size(); ++i) {
    error += std::norm(std::complex<double>(gathered.samples.values[i]) - summed.samples.values[i]);
    energy += std::norm(summed.samples.values[i]);
  }
  EXPECT_LT(std::sqrt(error / energy), 1e-6);
  // The card is between the viewer and the point behind the panel for some pixels, and not for others.
  const size_t first = 0, pixels = gathered_panel.pixels();
  size_t hidden = 0;
  for (size_t tile = 0; tile < pixels; ++tile) hidden += sources.tiles.values[tile * 3 + first] == 0;
  EXPECT_GT(hidden, pixels / 10);
  EXPECT_LT(hidden, pixels * 9 / 10);
}

TEST(Gather, IndependentPhasesBringTheIrradianceOfTheAcceptance) {
  // Cells of 1 nm: every ray has its own phase.
  const TraceParams params{
      .pixel_samples = 16, .paths = 1, .max_depth = 1, .phase = SourcePhase::surface, .grain = 1e-9};
  const double s = acceptance_sine(green_light, gathered_panel.pitch), expected = 4 * s * s * (1 - s * s / 3);
  // Intensity of 16 unit waves: its variance is 1 − 1/16 of its square; 3072 pixels, 4 standard errors: 7 %.
  const double error = 4 / std::sqrt(3072.0);
  EXPECT_NEAR(mean_intensity(gather(make_bright_wall(-20_mm), gathered_panel, green, params).at(0)) / expected, 1,
              error);
}

TEST(Gather, LinearAmplitudeIsProportionalToRadiance) {
  TraceParams params{.pixel_samples = 4, .paths = 1, .max_depth = 1, .phase = SourcePhase::surface};
  params.amplitude = AmplitudeLaw::linear;
  const double once = power(gather(make_bright_wall(-20_mm, 1), gathered_panel, green, params).at(0));
  EXPECT_NEAR(power(gather(make_bright_wall(-20_mm, 3), gathered_panel, green, params).at(0)) / once, 9,
              1e-5);  // floats
  params.amplitude = AmplitudeLaw::sqrt;
  EXPECT_NEAR(power(gather(make_bright_wall(-20_mm, 3), gathered_panel, green, params).at(0)) / once, 3, 1e-5);
}

TEST(Gather, PointsAreExactAndHiddenPixelByPixel) {
  Scene scene;
  scene.materials = {grey(0)};
  scene.meshes = {make_test_quad({5.004_mm, 0, -0.05}, {5_mm, 0, 0}, {0, 5_mm, 0})};  // covers x > 4 µm
  scene.points = {{{0, 0, -0.1}, 2.0f, 0.5f}};
  scene.lights = {PointLight{{0, 0, -10_mm}, {1, 1, 1}, true}};  // black card; phases are the laser's
  const double unit =
      green_light / std::sqrt(gathered_panel.width() * gathered_panel.height());  // for a point of 1 W/m²/sr
  const Field field =
      gather(scene, gathered_panel, green, {.pixel_samples = 1, .paths = 1, .phase = SourcePhase::laser}).at(0);
  for (int j = 0; j < gathered_panel.ny; ++j)
    for (int i = 0; i < gathered_panel.nx; ++i) {
      const double x = gathered_panel.x(i), y = gathered_panel.y(j), r = std::sqrt(x * x + y * y + 0.01);
      // The line to the point passes the card's plane at x/2.
      const auto expected =
          x / 2 > 4_um ? 0.0 : cis_cycles(cycle_fraction(r, green_light) + 0.5 / (2 * pi)) * (0.2 / r);
      EXPECT_LT(std::abs(std::complex<double>(field.samples(j, i)) / unit - expected), 1e-6);  // floats of modulus 2
    }
}

TEST(Gather, WithoutALaserPointsHaveTheRandomPhasesThatTraceGivesThem) {
  Scene scene;
  scene.points = {{{0, 0, -0.1}, 2.0f, 0.5f}, {{0, 10_um, -0.1}, 1.0f, 0}};
  TraceParams params{.pixel_samples = 1, .paths = 1, .phase = SourcePhase::laser};
  const Grid small{3, 3, 8e-6};
  Record record;
  const Field field = gather(scene, small, green, params, record.observer).at(0);
  ASSERT_EQ(record.warnings.size(), 1u);
  EXPECT_EQ(record.warnings[0], "no light of the scene is a laser: under the phase laser its waves have random phases");
  const Sources sources = trace(scene, small, green_light, params);
  std::complex<double> centre = 0;
  for (const Source& wave : sources.waves) {
    const double r = length(wave.origin);
    centre += std::polar(wave.amplitude * -wave.origin.z / r, double(wave.phase)) *
              cis_cycles(cycle_fraction(r, green_light));
  }
  EXPECT_LT(std::abs(std::complex<double>(field.samples(1, 1)) - centre), 1e-5);  // phases and fields are floats
}

TEST(Gather, ScenesUnseenOrDarkAreWarnedOf) {
  const TraceParams params{.pixel_samples = 1, .paths = 1, .phase = SourcePhase::surface};
  const auto warning = [&](const Scene& scene) {
    Record record;
    gather(scene, {8, 8, 8e-6}, green, params, record.observer);
    EXPECT_EQ(record.warnings.size(), 1u);
    return record.warnings.empty() ? "" : record.warnings[0];
  };
  Scene scene;
  scene.materials = {grey(0.5)};
  scene.meshes = {make_test_quad({0.2, 0, -0.3}, {5_mm, 0, 0}, {0, 5_mm, 0})};
  EXPECT_EQ(
      warning(scene),
      "none of 64 rays from the panel met a mesh: a panel of pitch 8 µm sees only 1.905° to each side of the axis at 532 "
      "nm; move the scene onto the axis or take a panel of finer pitch");
  scene.meshes = {make_wall(-0.3, 50_mm, 50_mm)};
  EXPECT_EQ(warning(scene), "every first hit is dark; add lights, emission or a background to the scene");
}

TEST(Gather, SetsAndTheirFramesComeInOrder) {
  Scene scene = make_bright_wall(-20_mm);
  scene.materials = {grey(0.5, 1)};
  scene.lights = {PointLight{{0, 0, -10_mm}, {1, 1, 1}}};
  const TraceParams params{.pixel_samples = 2,
                           .paths = 2,
                           .max_depth = 2,
                           .phase = SourcePhase::surface,
                           .separate_lights = true,
                           .frames = 3};
  const auto fields = gather(scene, {8, 6, 8e-6}, {630_nm, 460_nm}, params);
  ASSERT_EQ(fields.size(), 2u * 2u * 3u);  // wavelengths, the light and the emission, frames
  for (size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(fields[i].wavelength, i < 6 ? 630_nm : 460_nm);
    EXPECT_EQ(fields[i].label, (Label{i % 6 < 3 ? "light 0" : "emission", uint32_t(i % 3), 460_nm})) << i;
  }
  EXPECT_NE(fields[0].samples.values, fields[1].samples.values);
  // A frame draws new phases, not amplitudes: one ray of a set per pixel keeps its modulus.
  const auto single = gather(make_bright_wall(-20_mm), {8, 6, 8e-6}, green,
                             {.pixel_samples = 1, .paths = 1, .phase = SourcePhase::surface, .frames = 2});
  for (size_t i = 0; i < single[0].samples.size(); ++i)
    EXPECT_NEAR(std::abs(single[0].samples.values[i]), std::abs(single[1].samples.values[i]), 1e-8);
}

TEST(Gather, GivesTheSameBytesOnAnyNumberOfThreads) {
  std::vector<Field> results;
  for (const size_t threads : {1, 3}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(gather(make_bright_wall(-20_mm), gathered_panel, green,
                             {.pixel_samples = 3, .paths = 1, .phase = SourcePhase::path})
                          .at(0));
  }
  EXPECT_EQ(results[0].samples.values, results[1].samples.values);
}

TEST(Gather, CellsWiderThanTheRaysAreNoBrighter) {
  // Pixels of 64 µm accept ±83 µm of the wall: 30 cells of 30 µm, 8 rays each. One wave per ray would be 8 times too
  // bright. Pixels are a speckle or more apart, and their intensities exponential: for 63 pixels and 16 frames, 4
  // standard errors are 13 %.
  const TraceParams params{
      .pixel_samples = 256, .paths = 1, .max_depth = 1, .phase = SourcePhase::surface, .grain = 30e-6, .frames = 16};
  const Grid few{9, 7, 64e-6};
  const double s = acceptance_sine(green_light, few.pitch);
  double mean = 0;
  for (const Field& field : gather(make_bright_wall(-20_mm), few, green, params))
    mean += power(field) / (double(few.pixels()) * few.pitch * few.pitch) / 16;
  EXPECT_NEAR(mean / (4 * s * s * (1 - s * s / 3)), 1, 4 / std::sqrt(63.0 * 16));
}

TEST(Gather, RandomAndConstantPhasesAreGathered) {
  const double s = acceptance_sine(green_light, gathered_panel.pitch), expected = 4 * s * s * (1 - s * s / 3);
  Record record;
  TraceParams params{.pixel_samples = 16, .paths = 1, .max_depth = 1};
  const Field random = gather(make_bright_wall(-20_mm), gathered_panel, green, params, record.observer).at(0);
  EXPECT_NEAR(mean_intensity(random) / expected, 1, 4 / std::sqrt(3072.0));  // as with independent phases above
  ASSERT_EQ(record.warnings.size(), 1u);
  EXPECT_NE(record.warnings[0].find("is noise: the 16 rays of a pixel"), std::string::npos);
  // A wall of equal phase shines straight on: rays of all pixels agree once they resolve the 166² cells of ±0.67 mm.
  // Cut off there, the wave of irradiance L·(λ/p)² ripples at a pixel by N^(−1/2) on two sides, with the Fresnel number
  // N = (0.67 mm)²/(λ·20 mm) = 42.
  params.phase = SourcePhase::constant;
  params.pixel_samples = 200000;
  const Field constant = gather(make_bright_wall(-20_mm), {3, 3, 8e-6}, green, params).at(0);
  std::complex<double> sum = 0;
  double size = 0;
  for (const auto u : constant.samples.values) {
    sum += std::complex<double>(u);
    size += std::abs(u);
  }
  EXPECT_GT(std::abs(sum) / size, 0.98);
  EXPECT_NEAR(mean_intensity(constant) / expected, 1, 2 / std::sqrt(42.0));
}

TEST(Gather, RaysThatMeetACellInALaserBeamAgreeOnItsPhase) {
  // A wall of one cell: every pixel gets k·(r + beam's path) to the cell's middle, wherever its rays meet it.
  // Across the cell the phase of the oblique beam changes by up to k·30 µm·0.29 = 100 rad.
  const double grain = 30e-6;
  const Vec3 middle{(0.5 - 0.41421356) * grain, (0.5 - 0.73205081) * grain, -20_mm};
  const Vec3 direction = normalize({0.3, 0, -1}), position{0, 0, -10_mm};
  Scene scene;
  scene.materials = {grey(0.8)};
  scene.meshes = {make_test_quad(middle, {0.49 * grain, 0, 0}, {0, 0.49 * grain, 0})};
  scene.lights = {DirectionalLight{direction, {1, 1, 1}, position, std::numeric_limits<double>::infinity(), true}};
  const Grid few{6, 5, 40e-6 / 5};
  const TraceParams params{
      .pixel_samples = 16384, .paths = 1, .max_depth = 1, .phase = SourcePhase::laser, .grain = grain};  // 8 hits each
  const Field field = gather(scene, few, green, params).at(0);
  const double surface = random_phase(1, 0, surface_phase_key(middle, grain));
  for (int j = 0; j < few.ny; ++j)
    for (int i = 0; i < few.nx; ++i) {
      const double path = length(middle - Vec3{few.x(i), few.y(j), 0}) + dot(middle - position, direction);
      const auto expected = cis_cycles(cycle_fraction(path, green_light) + surface / (2 * pi));
      const std::complex<double> found(field.samples(j, i));
      ASSERT_GT(std::abs(found), 0);
      EXPECT_LT(std::abs(found / std::abs(found) - expected), 1e-5);  // floats
    }
}

TEST(Gather, TheHemisphereBringsItsWholeIrradiance) {
  // ∫ L cosθ dΩ over all directions to a wide wall: z = −20 mm and ±2 m leave out (20/2000)² of π.
  Scene scene;
  scene.materials = {grey(0, 1)};
  scene.meshes = {make_wall(-20_mm, 2.0, 2.0)};
  const TraceParams params{.pixel_samples = 64,
                           .directions = Directions::hemisphere,
                           .paths = 1,
                           .max_depth = 1,
                           .phase = SourcePhase::surface,
                           .grain = 1e-9};
  // 3072 pixels of contrast 1, and the strata of 64 rays that the disc cuts: less than √(π/4·(1−π/4)/(64·3072)) = 1e-3.
  const double error = 4 / std::sqrt(3072.0);
  EXPECT_NEAR(mean_intensity(gather(scene, gathered_panel, green, params).at(0)) / pi, 1, error);
}

TEST(Gather, ParametersOutOfRangeAreErrors) {
  const auto sentence = [](TraceParams params) {
    return error_of([&] { gather(make_bright_wall(-20_mm), gathered_panel, green, params); });
  };
  EXPECT_EQ(sentence({.pixel_samples = 0, .phase = SourcePhase::surface}),
            "expected a whole number of 1 or more for \"pixel_samples\", got 0");
}

}  // namespace
}  // namespace holotrace
