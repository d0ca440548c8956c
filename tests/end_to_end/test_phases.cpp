// Scene → Sources → Field: the brightness of surfaces under every phase, against closed forms.

#include <gtest/gtest.h>

#include <cmath>

#include "holotrace/data/acceptance.h"
#include "holotrace/trace/trace.h"
#include "holotrace/wave/propagate/propagate.h"
#include "holotrace/wave/synthesize.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

constexpr double lambda = green_light;

/// Irradiance at the middle of the panel of a square of radiance 1 and half-tangent t on the axis: ∫∫ cos⁴ over the
/// tangents, four corner rectangles' view factors times π.
double irradiance_of(double t) {
  const double s = std::sqrt(1 + t * t);
  return 4 * t / s * std::atan(t / s);
}

/// Mean intensity over the panel and over frames of independent phases, and the contrast of all its pixels.
struct Brightness {
  double mean = 0, contrast = 0;
};

Brightness measure(const Scene& scene, const Grid& panel, const TraceParams& params, int frames) {
  Sources sources = trace(scene, panel, lambda, params);
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

struct Case {
  SourcePhase phase;
  double depth;
  int columns;
  double grain;
};

TEST(Phases, AnEmissiveSquareHasItsIrradianceAtAnyDepthRasterAndGrain) {
  // Squares of side z/50. The raster spans ±z/50: the edges of its cells meet the square's, whatever its number.
  const Grid panel{128, 128, 8e-6};
  const Case cases[] = {
      {SourcePhase::random, 75_mm, 256, 0},       {SourcePhase::surface, 75_mm, 512, 0},
      {SourcePhase::surface, 150_mm, 256, 50e-6}, {SourcePhase::surface, 50_mm, 64, 4e-6},
      {SourcePhase::path, 75_mm, 512, 0},         {SourcePhase::path, 500_mm, 512, 100e-6},
      {SourcePhase::path, 100_mm, 512, 20e-6},
  };
  for (const Case& c : cases) {
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
    // irradiance of the panel's corners is less by 2·(0.7/50)² = 4e-4 at most.
    EXPECT_NEAR(found.mean / irradiance_of(0.01), 1, 0.03) << c.depth << " m, " << c.columns << ", " << c.grain;
  }
}

TEST(Phases, ASurfaceInStepBringsThePowerThatItsCellsBring) {
  // Under `constant` the light of a surface goes straight on; the power of all of it is that of its waves in their
  // boxes, L·A·∫∫ cos⁴ over the acceptance. The square is 64 whole cells wide, whose faces lie at (n − (0.41421356,
  // 0.73205081)) pixels. The panel of 2 mm holds all of it: it spreads by
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
      const double found = power(synthesize(trace(scene, panel, lambda, params), panel, {}));
      const double expected = 4 * half * half * irradiance_of(acceptance_tangent(lambda, panel.pitch));
      // Waves a pixel apart are orthogonal in one box of ±asin(λ/2p), but their boxes are apart, too, by a pixel of 83
      // or 166, and end at whole pixels: 2/83 at most for each axis.
      EXPECT_NEAR(found / expected, 1, 0.05) << depth << " m, " << per_cell;
    }
}

TEST(Phases, NearAndFarPatchesOfEqualRadianceAreEquallyBrightInTheView) {
  // Two squares of equal solid angle, side z·0.006, at 75 and at 300 mm, in a raster of 3.75 µm steps at the near one.
  const Grid panel{256, 256, 8e-6};
  Scene scene;
  scene.materials = {grey(0, 1)};
  const double near = 75_mm, far = 300_mm;
  scene.meshes = {make_test_quad({-0.006 * near, 0, -near}, {0.003 * near, 0, 0}, {0, 0.003 * near, 0}),
                  make_test_quad({0.006 * far, 0, -far}, {0.003 * far, 0, 0}, {0, 0.003 * far, 0})};
  const TraceParams params{.columns = 400,
                           .rows = 400,
                           .field_of_view = std::atan(0.01),
                           .paths = 1,
                           .max_depth = 1,
                           .phase = SourcePhase::surface};
  Sources sources = trace(scene, panel, lambda, params);
  const Grid wide{768, 768, 8e-6};  // holds the far square, as far as 2.7 mm
  double brightness[2] = {};
  constexpr int frames = 4;
  for (int frame = 0; frame < frames; ++frame) {
    set_frame(sources, uint32_t(frame));
    const Field field = synthesize(sources, panel, {});
    Field padded(wide, lambda);
    for (int j = 0; j < panel.ny; ++j)
      for (int i = 0; i < panel.nx; ++i) padded.samples(j + 256, i + 256) = field.samples(j, i);
    for (const bool is_far : {false, true}) {
      const double depth = is_far ? far : near, middle = (is_far ? 0.006 : -0.006) * depth, half = 0.003 * depth;
      const Field image = propagate(padded, -depth);
      double sum = 0;
      for (int j = 0; j < wide.ny; ++j)
        for (int i = 0; i < wide.nx; ++i)
          if (std::abs(wide.x(i) - middle) < half && std::abs(wide.y(j)) < half)
            sum += std::norm(image.samples(j, i)) * wide.pitch * wide.pitch;
      brightness[is_far] += sum / (4 * half * half) * depth * depth / frames;  // per solid angle of the panel
    }
  }
  // Either image has 0.006·2.05 mm/λ = 23 resolved places to a side: 530 speckles in 4 frames, a standard error of 2.2
  // % each and 3.1 % of the ratio.
  EXPECT_NEAR(brightness[0] / brightness[1], 1, 4 * 0.031);
}

TEST(Phases, APlateInALaserBeamIsLambertian) {
  // A plate of reflectance 0.8, 2 mm wide at −200 mm, under beams at 0°, 1.1° and 16.7°.
  const Grid panel{256, 256, 8e-6};
  const double depth = 200_mm;
  for (const double slope : {0.0, 0.02, 0.3}) {
    Scene scene;
    scene.materials = {grey(0.8)};
    scene.meshes = {make_wall(-depth, 1_mm, 1_mm)};
    scene.lights = {DirectionalLight{
        normalize({slope, 0, -1}), {1, 1, 1}, {0, 0, -0.1}, std::numeric_limits<double>::infinity(), true}};
    // Edges of the raster's cells, 20 µm wide, meet the plate's.
    const TraceParams params{.columns = 200,
                             .rows = 200,
                             .field_of_view = std::atan(0.01),
                             .paths = 1,
                             .max_depth = 1,
                             .phase = SourcePhase::laser};
    const Brightness found = measure(scene, panel, params, 8);
    const double lambert = 0.8 / pi / std::sqrt(1 + slope * slope) * irradiance_of(0.005);
    // Speckles of 100·λ = 53 µm: 1480 on the panel, in 8 frames: 0.9 % of the mean, and √8·0.9 %/2 of the contrast at
    // most (the variance of an exponential's variance is 8).
    EXPECT_NEAR(found.mean / lambert, 1, 0.05) << slope;
    EXPECT_NEAR(found.contrast, 1, 0.05) << slope;
  }
}

}  // namespace
}  // namespace holotrace
