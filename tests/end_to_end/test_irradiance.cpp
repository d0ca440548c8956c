// Scene → Sources → Field: the mean intensity on the panel is the irradiance from radiometry for a wall under a lamp,
// for every strategy and every pattern of first hits.

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
constexpr double depth = 20e-3, height = 1e-3, albedo = 0.6;  // the lamp is `height` in front of the wall
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

/// π times the view factor from a point to a parallel rectangle a × b with one corner above the point.
double under_a_corner(double a, double b) {
  const double A = a / height, B = b / height, p = std::sqrt(1 + A * A), q = std::sqrt(1 + B * B);
  return (A / p * std::atan(B / p) + B / q * std::atan(A / q)) / 2;
}

constexpr double half_lamp = 0.5e-3;

/// Irradiance at (x, y) on the wall under a square of radiance 1 above its middle, from four rectangles with signs.
double under_a_square(double x, double y) {
  return under_a_corner(half_lamp - x, half_lamp - y) + under_a_corner(half_lamp + x, half_lamp - y) +
         under_a_corner(half_lamp - x, half_lamp + y) + under_a_corner(half_lamp + x, half_lamp + y);
}

/// Mean over the panel of ∫ L·cos⁴θ dt over the square of tangents |tₓ|, |t_y| ≤ T, L = albedo·E/π at the point that
/// the ray meets. Midpoint rule with 9 × 9 positions and 60 × 60 tangents. The integrands vary by a half, so the error
/// is at most 5e-4: (1/60)² and (1/9)² with the rule's factor 1/24.
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

/// Σ|U|² over the pixels, averaged over frames.
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
    // The raster must contain what every pixel sees, not only the middle: T + 0.32 mm/20 mm of diagonal is below 0.06.
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
    // Cells of 1 nm: every ray has its own phase.
    {"gather", {.strategy = Strategy::gather, .pixel_samples = 16, .phase = SourcePhase::surface, .grain = 1e-9}},
};

void expect_irradiance(const Light& lamp, const std::function<double(double, double)>& irradiance) {
  const Scene scene = make_lit_wall(lamp);
  const double expected = expected_irradiance(irradiance);
  // A panel with the full acceptance of its pitch has one speckle per pixel: independent intensities of contrast 1.
  // 3072 pixels and 16 frames: a standard error of 0.45 %, four of which are 1.8 %. The noise of the rays is lower:
  // their positions are stratified, and even if they were not, 8000 rays whose L varies by a third would give 0.3 %.
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
  // u × v points to −z, toward the wall. The lamp does not hide the wall, so the panel sees all of it.
  RectangleLight lamp{
      {-half_lamp, -half_lamp, -depth + height}, {0, 2 * half_lamp, 0}, {2 * half_lamp, 0, 0}, {1, 1, 1}};
  lamp.is_visible = false;
  expect_irradiance(lamp, under_a_square);
}

}  // namespace
}  // namespace holotrace
