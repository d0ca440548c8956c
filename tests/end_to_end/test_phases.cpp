// Scene → Sources → Field: the brightness of surfaces with every kind of phase, against closed forms.

#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/data/acceptance.h"
#include "holotrace/trace/trace.h"
#include "holotrace/view/camera.h"
#include "holotrace/wave/synthesize.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

/// Irradiance at the middle of the panel from a square of radiance 1 and half-tangent t on the axis: ∫∫ cos⁴ over the
/// tangents, from the view factors of four rectangles times π.
double irradiance_of(double t) {
  const double s = std::sqrt(1 + t * t);
  return 4 * t / s * std::atan(t / s);
}

/// Mean intensity over the panel and over frames with independent phases, and the contrast of all pixels.
struct Brightness {
  double mean = 0, contrast = 0;
};

Brightness measure(const Scene& scene, const Grid& panel, const TraceParams& params, int frames) {
  Sources sources = trace(scene, panel, green_light, params);
  double sum = 0, squares = 0;
  for (int frame = 0; frame < frames; ++frame) {
    set_frame(sources, uint32_t(frame));
    const Field field = synthesize(sources, panel, {});
    for (const auto u : field.samples.values) {
      const double intensity = std::norm(u);
      sum += intensity;
      squares += intensity * intensity;
    }
  }
  const double count = double(panel.pixels()) * frames, mean = sum / count;
  return {mean, std::sqrt(squares / count - mean * mean) / mean};
}

struct PhaseCase {
  SourcePhase phase;
  double depth;
  int columns;
  double grain;
};

TEST(Phases, AnEmissiveSquareHasItsIrradianceAtAnyDepthRasterAndGrain) {
  // Squares of side z/50. The raster spans ±z/50: edges of its cells coincide with the square's, for every number.
  const Grid panel{128, 128, 8e-6};
  const PhaseCase cases[] = {
      {SourcePhase::random, 75_mm, 256, 0},       {SourcePhase::surface, 75_mm, 512, 0},
      {SourcePhase::surface, 150_mm, 256, 50e-6}, {SourcePhase::surface, 50_mm, 64, 4e-6},
      {SourcePhase::path, 75_mm, 512, 0},         {SourcePhase::path, 500_mm, 512, 100e-6},
      {SourcePhase::path, 100_mm, 512, 20e-6},
  };
  for (const PhaseCase& c : cases) {
    Scene scene;
    scene.materials = {grey(0, 1)};
    scene.meshes = {make_wall(-c.depth, c.depth / 100, c.depth / 100)};
    const TraceParams params{.columns = c.columns,
                             .rows = c.columns,
                             .field_of_view = std::atan(0.02),
                             .paths = 1,
                             .max_depth = 1,
                             .phase = c.phase,
                             .grain = c.grain};
    const Brightness found = measure(scene, panel, params, 8);
    // Speckles are 50·λ = 27 µm wide: 1480 on the panel, exponential, in 8 frames: a standard error of 0.9 %. The
    // irradiance at the panel's corners is lower by at most 2·(0.7/50)² = 4e-4.
    EXPECT_NEAR(found.mean / irradiance_of(0.01), 1, 0.03) << c.depth << " m, " << c.columns << ", " << c.grain;
  }
}

TEST(Phases, ASurfaceInStepBringsThePowerThatItsCellsBring) {
  // With `constant` phases the light of a surface goes straight on. Its total power is that of its waves in their
  // boxes, L·A·∫∫ cos⁴ over the acceptance. The square is 64 whole cells wide, whose faces lie at (n − (0.41421356,
  // 0.73205081)) pixels. The panel of 2 mm contains all of the light: it spreads by
  // no more than a few λz/0.5 mm = 40 µm.
  const Grid panel{256, 256, 8e-6};
  const double pixel = panel.pitch, half = 32 * pixel;
  for (const double depth : {20_mm, 40_mm})
    for (const int per_cell : {3, 8}) {  // steps of a raster of ±33 pixels
      Scene scene;
      scene.materials = {grey(0, 1)};
      scene.meshes = {make_test_quad({-0.41421356 * pixel, 0.26794919 * pixel, -depth}, {half, 0, 0}, {0, half, 0})};
      const TraceParams params{.columns = 66 * per_cell,
                               .rows = 66 * per_cell,
                               .field_of_view = std::atan(33 * pixel / depth),
                               .paths = 1,
                               .max_depth = 1,
                               .phase = SourcePhase::constant};
      const double found = power(synthesize(trace(scene, panel, green_light, params), panel, {}));
      const double expected = 4 * half * half * irradiance_of(acceptance_tangent(green_light, panel.pitch));
      // Waves a pixel apart are orthogonal in one box of ±asin(λ/2p). But their boxes are also a pixel of 83 or 166
      // apart, and end at whole pixels: at most 2/83 for each axis.
      EXPECT_NEAR(found / expected, 1, 0.05) << depth << " m, " << per_cell;
    }
}

/// Mean irradiance of a square of the view, with its centre and side [m] in the plane at `depth`.
double brightness_in_view(const Field& field, double depth, Vec2 middle, double side) {
  CameraParams camera;
  camera.width = camera.height = side;
  camera.pixel = side / 64;
  camera.centre_x = middle.x;
  camera.centre_y = middle.y;
  const Image view = look(field, {.grid = field.grid}, depth, {}, camera);
  double sum = 0;
  for (const float value : view.values) sum += value;
  return sum / double(view.values.size());
}

class NearAndFar : public ::testing::TestWithParam<SourcePhase> {};

// Two squares of radiance L and side z·0.012, at 75 and at 300 mm, through the whole panel of area A. A camera that
// receives all their light sees L·A/z² in both. The light of each misses the other square. Both have the same 46
// resolved places per side, λz/2.05 mm wide, and lose the same light over their edges.
TEST_P(NearAndFar, PatchesOfEqualRadianceAreEquallyBrightInTheView) {
  const bool has_laser = GetParam() == SourcePhase::laser;
  const Grid panel{256, 256, 8e-6};
  Scene scene;
  scene.materials = {has_laser ? grey(0.8) : grey(0, 1)};
  if (has_laser)
    scene.lights = {
        DirectionalLight{{0, 0, -1}, {1, 1, 1}, {0, 0, -10_mm}, std::numeric_limits<double>::infinity(), true}};
  const double radiance = has_laser ? 0.8 / pi : 1;  // of a Lambertian plate at 1 W/m²
  const double depths[] = {75_mm, 300_mm}, slopes[] = {-0.013, 0.01};
  for (int i = 0; i < 2; ++i) {
    const double half = 0.006 * depths[i];
    scene.meshes.push_back(make_test_quad({slopes[i] * depths[i], 0, -depths[i]}, {half, 0, 0}, {0, half, 0}));
  }
  // Cells of 1.2e-4: the squares are 100 cells wide.
  const TraceParams params{
      .columns = 400, .rows = 400, .field_of_view = std::atan(0.024), .paths = 1, .max_depth = 1, .phase = GetParam()};
  Sources sources = trace(scene, panel, green_light, params);
  double brightness[2] = {};
  constexpr int frames = 10;
  for (int frame = 0; frame < frames; ++frame) {
    set_frame(sources, uint32_t(frame));
    const Field field = synthesize(sources, panel, {});
    for (int i = 0; i < 2; ++i)
      brightness[i] += brightness_in_view(field, depths[i], {slopes[i] * depths[i], 0}, 0.012 * depths[i]) * depths[i] *
                       depths[i] / (panel.width() * panel.height() * radiance * frames);
  }
  // 46² speckles in 10 frames, exponential: 0.69 % each, 0.97 % of the ratio: 3 % are three standard errors.
  EXPECT_NEAR(brightness[0] / brightness[1], 1, 0.03);
  // The light beyond the edges is (ln(2π·46) + γ + 1)/(π²·46) = 1.6 % in each axis: tails of sinc² of an even square.
  for (const double b : brightness) EXPECT_NEAR(b, 0.968, 0.03);
}

INSTANTIATE_TEST_SUITE_P(Phases, NearAndFar,
                         ::testing::Values(SourcePhase::random, SourcePhase::surface, SourcePhase::path,
                                           SourcePhase::laser));

TEST(Phases, NearAndFarPatchesInStepAreEquallyBrightWhereTheCameraTakesAllTheirLight) {
  // With `constant` phases a surface sends all its light straight on: that of a cell of area p² through the whole
  // acceptance Ω, L·p²·Ω, goes into one direction. So a camera that receives this direction sees L·Ω at any depth,
  // not L·A/z². Two squares of 64 cells at 20 and at 40 mm, side by side. The panel contains their light with 60 cells
  // around it; diffraction spreads the light by λz/0.5 mm, 3 and 5 cells.
  const Grid panel{512, 512, 8e-6};
  const double pixel = panel.pitch, half = 32 * pixel, depths[] = {20_mm, 40_mm}, at[] = {-100 * pixel, 100 * pixel};
  // Faces of the cells are at (n − (0.41421356, 0.73205081)) pixels.
  const double x0 = -0.41421356 * pixel, y0 = 0.26794919 * pixel;
  Scene scene;
  scene.materials = {grey(0, 1)};
  for (int i = 0; i < 2; ++i)
    scene.meshes.push_back(make_test_quad({at[i] + x0, y0, -depths[i]}, {half, 0, 0}, {0, half, 0}));
  const int cells = 133, per_cell = 4;  // of the near plane, on each side of the axis; the far one has twice as many
  const TraceParams params{.columns = 2 * cells * per_cell,
                           .rows = 2 * cells * per_cell,
                           .field_of_view = std::atan(cells * pixel / depths[0]),
                           .paths = 1,
                           .max_depth = 1,
                           .phase = SourcePhase::constant};
  const Field field = synthesize(trace(scene, panel, green_light, params), panel, {});
  double brightness[2] = {};
  for (int i = 0; i < 2; ++i) brightness[i] = brightness_in_view(field, depths[i], {at[i] + x0, y0}, 2 * half);
  // A box of 83 pixels to each side ends at whole pixels: 1/83 of its light for each axis. Nothing here is random.
  EXPECT_NEAR(brightness[0] / brightness[1], 1, 0.03);
  for (const double b : brightness) EXPECT_NEAR(b / irradiance_of(acceptance_tangent(green_light, pixel)), 1, 0.03);
}

TEST(Phases, APlateInALaserBeamIsLambertian) {
  // A plate of reflectance 0.8, 2 mm wide at −200 mm, in beams at 0°, 1.1° and 16.7°.
  const Grid panel{256, 256, 8e-6};
  const double depth = 200_mm;
  for (const double slope : {0.0, 0.02, 0.3}) {
    Scene scene;
    scene.materials = {grey(0.8)};
    scene.meshes = {make_wall(-depth, 1_mm, 1_mm)};
    scene.lights = {DirectionalLight{
        normalize({slope, 0, -1}), {1, 1, 1}, {0, 0, -0.1}, std::numeric_limits<double>::infinity(), true}};
    // Edges of the raster's cells, 20 µm wide, coincide with the plate's.
    const TraceParams params{.columns = 200,
                             .rows = 200,
                             .field_of_view = std::atan(0.01),
                             .paths = 1,
                             .max_depth = 1,
                             .phase = SourcePhase::laser};
    const Brightness found = measure(scene, panel, params, 8);
    const double lambert = 0.8 / pi / std::sqrt(1 + slope * slope) * irradiance_of(0.005);
    // Speckles of 100·λ = 53 µm: 1480 on the panel, in 8 frames: 0.9 % of the mean, and at most √8·0.9 %/2 of the
    // contrast (the variance of an exponential's variance is 8).
    EXPECT_NEAR(found.mean / lambert, 1, 0.05) << slope;
    EXPECT_NEAR(found.contrast, 1, 0.05) << slope;
  }
}

}  // namespace
}  // namespace holotrace
