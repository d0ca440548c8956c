// Scene → Sources → Field: the mean intensity on the panel is the irradiance that radiometry gives a wall under a lamp,
// by every strategy and every pattern of first hits.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "holotrace/data/acceptance.h"
#include "holotrace/trace/gather.h"
#include "holotrace/trace/trace.h"
#include "holotrace/wave/synthesize.h"
#include "trace/scenes.h"

namespace holotrace {
namespace {

const Grid panel{64, 48, 8e-6};
constexpr double depth = 20e-3, height = 1e-3, albedo = 0.6;  // the lamp stands `height` before the wall
constexpr int frames = 16;

Scene make_lit_wall(const Light& lamp) {
  Scene scene;
  scene.materials = {grey(albedo)};
  scene.meshes = {make_wall(-depth, 5_mm, 5_mm)};
  scene.lights = {lamp};
  return scene;
}

/// I·cosθ/r² at (x, y) on the wall under a point of I = 1 W/sr above its middle.
double under_a_point(double x, double y) { return height / std::pow(height * height + x * x + y * y, 1.5); }

/// π times the view factor from a spot to a parallel rectangle a × b with one corner above the spot.
double under_a_corner(double a, double b) {
  const double A = a / height, B = b / height, p = std::sqrt(1 + A * A), q = std::sqrt(1 + B * B);
  return (A / p * std::atan(B / p) + B / q * std::atan(A / q)) / 2;
}

constexpr double half_lamp = 0.5e-3;

/// Irradiance at (x, y) on the wall under a square of radiance 1 above its middle: four corner rectangles with signs.
double under_a_square(double x, double y) {
  return under_a_corner(half_lamp - x, half_lamp - y) + under_a_corner(half_lamp + x, half_lamp - y) +
         under_a_corner(half_lamp - x, half_lamp + y) + under_a_corner(half_lamp + x, half_lamp + y);
}

/// Mean over the panel of ∫ L·cos⁴θ dt over the square of tangents |tₓ|, |t_y| ≤ T, L = albedo·E/π at the place that
/// the ray meets. Midpoints of 9 × 9 places and 60 × 60 tangents: (1/60)² and (1/9)² of integrands that vary by a half,
/// with the midpoint rule's 1/24: 5e-4 at most.
double expected_irradiance(const std::function<double(double, double)>& irradiance) {
  const double tangent = acceptance_tangent(green_light, panel.pitch);
  constexpr int places = 9, rays = 60;
  double sum = 0;
  for (int j = 0; j < places; ++j)
    for (int i = 0; i < places; ++i)
      for (int b = 0; b < rays; ++b)
        for (int a = 0; a < rays; ++a) {
          const double tx = tangent * ((2 * a + 1.0) / rays - 1), ty = tangent * ((2 * b + 1.0) / rays - 1);
          const double x = panel.width() * ((i + 0.5) / places - 0.5) + depth * tx;
          const double y = panel.height() * ((j + 0.5) / places - 0.5) + depth * ty;
          sum += irradiance(x, y) / ((1 + tx * tx + ty * ty) * (1 + tx * tx + ty * ty));
        }
  return albedo / pi * sum / (places * places) * std::pow(2 * tangent / rays, 2);
}

/// Σ|U|² over the pixels, mean over frames.
double mean_intensity(const Scene& scene, TraceParams params) {
  params.paths = 16;
  params.max_depth = 1;
  double sum = 0;
  if (params.strategy == Strategy::gather) {
    params.frames = frames;
    for (const Field& field : gather(scene, panel, {green_light}, params)) sum += power(field);
  } else {
    Sources sources = trace(scene, panel, green_light, params);
    for (int frame = 0; frame < frames; ++frame) {
      set_frame(sources, uint32_t(frame));
      sum += power(synthesize(sources, panel, {}));
    }
  }
  return sum / frames / (double(panel.pixels()) * panel.pitch * panel.pitch);
}

struct Case {
  const char* name;
  TraceParams params;
};

const Case cases[] = {
    // The raster must hold what every pixel sees, not the middle alone: T + 0.32 mm/20 mm of diagonal is below 0.06.
    {"shared grid", {.columns = 128, .rows = 128, .field_of_view = std::atan(0.06)}},
    {"shared random", {.pattern = Pattern::random, .samples = 8000}},
    {"tiled grid",
     {.strategy = Strategy::tiled,
      .columns = 128,
      .rows = 128,
      .tile_columns = 3,
      .tile_rows = 2,
      .field_of_view = std::atan(0.06)}},
    {"tiled random",
     {.strategy = Strategy::tiled, .pattern = Pattern::random, .samples = 8000, .tile_columns = 3, .tile_rows = 2}},
    // Cells of 1 nm: every ray a phase of its own.
    {"gather", {.strategy = Strategy::gather, .pixel_samples = 16, .phase = SourcePhase::surface, .grain = 1e-9}},
};

void expect_irradiance(const Light& lamp, const std::function<double(double, double)>& irradiance) {
  const Scene scene = make_lit_wall(lamp);
  const double expected = expected_irradiance(irradiance);
  // A panel that accepts all that its pitch can hold has one speckle per pixel: intensities of contrast 1, independent.
  // 3072 pixels and 16 frames: a standard error of 0.45 %, 4 of which are 1.8 %. The rays' own noise is less: places
  // are stratified, and 8000 of them whose L varies by a third bring 0.3 % even if they were not.
  const double error = 4 / std::sqrt(double(panel.pixels()) * frames);
  for (const Case& c : cases) {
    const double ratio = mean_intensity(scene, c.params) / expected;
    EXPECT_NEAR(ratio, 1, error) << c.name;
    testing::Test::RecordProperty(std::string("ratio ") + c.name, std::to_string(ratio));
  }
}

TEST(Irradiance, OfAWallUnderAPointIsTheMeanIntensityByEveryStrategy) {
  expect_irradiance(PointLight{{0, 0, -depth + height}, {1, 1, 1}}, under_a_point);
}

TEST(Irradiance, OfAWallUnderASquareLampIsTheMeanIntensityByEveryStrategy) {
  // u × v points to −z: it shines onto the wall. It does not hide the wall, so that the panel sees all of it.
  RectangleLight lamp{
      {-half_lamp, -half_lamp, -depth + height}, {0, 2 * half_lamp, 0}, {2 * half_lamp, 0, 0}, {1, 1, 1}};
  lamp.is_visible = false;
  expect_irradiance(lamp, under_a_square);
}

}  // namespace
}  // namespace holotrace
