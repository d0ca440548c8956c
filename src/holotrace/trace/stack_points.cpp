#include "holotrace/trace/stack_points.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/trace/camera_rays.h"

namespace holotrace {

namespace {

/// An interval on one axis [m].
struct Interval {
  double low, high;
  double size() const { return std::max(0.0, high - low); }
  double centre() const { return (low + high) / 2; }
};

/// The part of an interval that a place sees with that reach.
Interval seen_part(const Interval& whole, double place, double reach) {
  return {std::max(whole.low, place - reach), std::min(whole.high, place + reach)};
}

/// A row or column of pixels along one axis: centres at first + i·step.
struct Pixels {
  double first, step;
  int count;
};

struct Share {
  int pixel;
  double light;  // of one pixel, times its width over the width of the image
};

/// How the light of a point is shared among the pixels of one axis. The point at `place` and depth D is seen from the
/// part `lens` of the panel; each pixel is a mean over the part of the lens that it sees.
std::vector<Share> shares(const Pixels& pixels, const Interval& lens, double place, double depth, double distance,
                          double tangent) {
  const Interval seen = seen_part(lens, place, tangent * std::abs(depth));
  if (!(seen.size() > 0)) return {};
  const double ratio = distance / depth, pitch = std::abs(pixels.step);
  const double centre = seen.centre() + (place - seen.centre()) * ratio;
  const double half = std::max(seen.size() * std::abs(1 - ratio), pitch) / 2;
  const double ends[] = {(centre - half - pixels.first) / pixels.step, (centre + half - pixels.first) / pixels.step};
  const double begin = std::min(ends[0], ends[1]), end = std::max(ends[0], ends[1]);  // in pixels, centres at integers
  std::vector<Share> result;
  for (int i = int(std::clamp(std::floor(begin + 0.5), 0.0, double(pixels.count))); i < pixels.count; ++i) {
    const double covered = std::min(end, i + 0.5) - std::max(begin, i - 0.5);
    if (covered <= 0) break;
    const Interval of_pixel = seen_part(lens, pixels.first + i * pixels.step, tangent * std::abs(distance));
    if (of_pixel.size() > 0) result.push_back({i, covered / (end - begin) * seen.size() / of_pixel.size()});
  }
  return result;
}

}  // namespace

void draw_points(const Accelerator& scene, const PanelPart& part, const PixelPlane& plane, Image& picture) {
  const Grid& grid = plane.grid;
  const Pixels columns{grid.x(0), grid.pitch, grid.nx}, rows{grid.y(0), -grid.pitch, grid.ny};
  const Vec3 centre{(part.left + part.right) / 2, (part.low + part.high) / 2, part.z};
  for (const ScenePoint& point : scene.scene().points) {
    const double depth = part.z - point.position.z;
    if (part.z > 0 && depth <= 0) continue;  // behind the viewer
    const auto across = shares(columns, {part.left, part.right}, point.position.x, depth, plane.distance, part.tangent);
    const auto down = shares(rows, {part.low, part.high}, point.position.y, depth, plane.distance, part.tangent);
    if (across.empty() || down.empty() || scene.is_hidden(centre, point.position)) continue;
    const double side = grid.pitch / std::abs(plane.distance);  // of a pixel, as a tangent
    const double light = point_light(point, centre, part.panel, part.wavelength) / (side * side);
    for (const Share& row : down)
      for (const Share& column : across)
        for (int channel = 0; channel < picture.channels; ++channel)
          picture(row.pixel, column.pixel, channel) += float(light * row.light * column.light);
  }
}

}  // namespace holotrace
