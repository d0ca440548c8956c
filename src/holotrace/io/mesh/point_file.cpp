#include "holotrace/io/mesh/point_file.h"

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/io/files/ply.h"

namespace holotrace {
namespace {

double pick_channel(PointChannel channel, double red, double green, double blue) {
  switch (channel) {
    case PointChannel::red:
      return red;
    case PointChannel::green:
      return green;
    case PointChannel::blue:
      return blue;
    case PointChannel::luminance:
      break;
  }
  return luminance(red, green, blue);
}

}  // namespace

std::vector<ScenePoint> load_points(const std::string& path, PointChannel channel) {
  const PlyVertices vertices = read_ply(path);
  require(vertices.count > 0, "{}: expected points, got none", path);
  const auto& x = vertices.column("x");
  const auto& y = vertices.column("y");
  const auto& z = vertices.column("z");
  const auto* amplitude = vertices.find("amplitude");
  const auto* phase = vertices.find("phase");
  const auto* red = vertices.find("red");
  const auto* green = vertices.find("green");
  const auto* blue = vertices.find("blue");

  std::vector<ScenePoint> points(vertices.count);
  for (size_t i = 0; i < points.size(); ++i) {
    ScenePoint& point = points[i];
    point.position = {x[i], y[i], z[i]};
    if (amplitude) {
      point.amplitude = float((*amplitude)[i]);
    } else if (red && green && blue) {
      point.amplitude = float(pick_channel(channel, (*red)[i], (*green)[i], (*blue)[i]) / 255);
    }
    if (phase) point.phase = float((*phase)[i]);
    require(is_finite(point.position) && std::isfinite(point.amplitude) && std::isfinite(point.phase),
            "{}: expected finite numbers, got ({}, {}, {}), amplitude {}, phase {} at point {}", path, x[i], y[i], z[i],
            point.amplitude, point.phase, i);
  }
  return points;
}

}  // namespace holotrace
