#include "holotrace/io/mesh/point_file.h"

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/data/spectrum.h"
#include "holotrace/io/files/ply.h"
#include "holotrace/io/mesh/stored_colours.h"

namespace holotrace {
namespace {

double pick_channel(PointChannel channel, Vec3 colour) {
  switch (channel) {
    case PointChannel::red:
      return colour.x;
    case PointChannel::green:
      return colour.y;
    case PointChannel::blue:
      return colour.z;
    case PointChannel::luminance:
      break;
  }
  return luminance(colour.x, colour.y, colour.z);
}

}  // namespace

std::vector<ScenePoint> load_points(const std::string& path, PointChannel channel, std::vector<std::string>* warnings) {
  const PlyVertices vertices = read_ply(path);
  require(vertices.count > 0, "{}: expected points, got none", path);
  const auto& x = vertices.column("x");
  const auto& y = vertices.column("y");
  const auto& z = vertices.column("z");
  const auto* amplitude = vertices.find("amplitude");
  const auto* phase = vertices.find("phase");
  std::vector<std::string> unheard;
  const StoredColours colours = ply_colours(vertices, warnings ? *warnings : unheard);
  std::vector<ScenePoint> points(vertices.count);
  for (size_t i = 0; i < points.size(); ++i) {
    ScenePoint& point = points[i];
    point.position = {x[i], y[i], z[i]};
    if (amplitude) {
      point.amplitude = float((*amplitude)[i]);
    } else if (!colours.values.empty()) {
      point.amplitude = float(pick_channel(channel, stored_colour(colours, i)));
    }
    if (phase) point.phase = float((*phase)[i]);
    require(is_finite(point.position) && std::isfinite(point.amplitude) && std::isfinite(point.phase),
            "{}: expected finite numbers, got ({}, {}, {}), amplitude {}, phase {} at point {}", path, x[i], y[i], z[i],
            point.amplitude, point.phase, i);
  }
  return points;
}

}  // namespace holotrace
