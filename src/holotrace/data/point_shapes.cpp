// Shapes of luminous points.

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/shape_parts.h"
#include "holotrace/data/shapes.h"

namespace holotrace {
namespace {

// Light of an image at the fractional pixel (x, y): bilinear interpolation, channels weighted.
double light_at(const Image& image, Vec3 weights, double x, double y) {
  const auto pixel = [&](int row, int column) -> double {
    if (image.channels < 3) return image(row, column);
    return weights.x * image(row, column, 0) + weights.y * image(row, column, 1) + weights.z * image(row, column, 2);
  };
  const int i = std::min(int(x), image.nx - 1), j = std::min(int(y), image.ny - 1);
  const int i1 = std::min(i + 1, image.nx - 1), j1 = std::min(j + 1, image.ny - 1);
  const double s = x - i, t = y - j;
  return (1 - t) * ((1 - s) * pixel(j, i) + s * pixel(j, i1)) + t * ((1 - s) * pixel(j1, i) + s * pixel(j1, i1));
}

}  // namespace

std::vector<ScenePoint> make_wireframe_cube(double size, int per_edge) {
  check_side(size, "a wireframe cube", "size");
  require(per_edge >= 2, "expected 2 points or more on an edge of a wireframe cube, got {}", per_edge);
  const int last = per_edge - 1;
  const auto at = [&](int i) { return size * (double(i) / last - 0.5); };
  std::vector<ScenePoint> points;
  points.reserve(size_t(12) * size_t(per_edge) - 16);
  const auto add = [&](int i, int j, int k) { points.push_back({{at(i), at(j), at(k)}}); };
  for (int k : {0, last})
    for (int j : {0, last})
      for (int i : {0, last}) add(i, j, k);
  for (int a : {0, last})
    for (int b : {0, last})
      for (int i = 1; i < last; ++i) {
        add(i, a, b);
        add(a, i, b);
        add(a, b, i);
      }
  return points;
}

std::vector<ScenePoint> make_wireframe_sphere(double size, int meridians, int parallels, int per_circle) {
  check_side(size, "a wireframe sphere", "size");
  require(meridians >= 1 && parallels >= 0 && per_circle >= 3,
          "expected a wireframe sphere of 1 meridian, 0 parallels and 3 points on a circle or more, got {}, {} and {}",
          meridians, parallels, per_circle);
  const double radius = size / 2;
  std::vector<ScenePoint> points{{{0, radius, 0}}, {{0, -radius, 0}}};
  const auto add = [&](double polar, double azimuth) {
    points.push_back({{radius * std::sin(polar) * std::sin(azimuth), radius * std::cos(polar),
                       radius * std::sin(polar) * std::cos(azimuth)}});
  };
  const int steps = (per_circle + 1) / 2;  // steps from pole to pole
  for (int m = 0; m < meridians; ++m)
    for (int s = 1; s < steps; ++s) add(pi * s / steps, 2 * pi * m / meridians);
  for (int p = 1; p <= parallels; ++p) {
    // Where the parallel crosses a meridian at one of the meridian's points, that point exists already.
    const bool meets = int64_t(p) * steps % (parallels + 1) == 0;
    for (int i = 0; i < per_circle; ++i)
      if (!(meets && int64_t(i) * meridians % per_circle == 0)) add(pi * p / (parallels + 1), 2 * pi * i / per_circle);
  }
  return points;
}

std::vector<ScenePoint> make_point_quad(double width, double height, int columns, int rows, const Image* texture,
                                        Vec3 weights) {
  check_side(width, "a point quad", "width");
  check_side(height, "a point quad", "height");
  require(columns >= 2 && rows >= 2, "expected a point quad of 2 × 2 points or more, got {} × {}", columns, rows);
  require(!texture || (texture->nx > 0 && texture->ny > 0),
          "expected a texture with pixels for a point quad, got none");
  std::vector<ScenePoint> points;
  points.reserve(size_t(columns) * size_t(rows));
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const double s = double(i) / (columns - 1), t = double(j) / (rows - 1);
      ScenePoint point{{width * (s - 0.5), height * (0.5 - t), 0}};
      if (texture) {
        const double light = light_at(*texture, weights, s * (texture->nx - 1), t * (texture->ny - 1));
        point.amplitude = float(std::sqrt(std::max(light, 0.0)));
      }
      points.push_back(point);
    }
  return points;
}

}  // namespace holotrace
