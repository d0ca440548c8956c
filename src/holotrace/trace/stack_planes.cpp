#include "holotrace/trace/stack_planes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/trace/camera_rays.h"

namespace holotrace {
namespace {

/// Part of one side of the panel that a point at x can see.
struct Side {
  double low, high;  // ends of the panel's side
  double reach;      // largest distance along this axis

  double low_seen(double x) const { return std::max(low, x - reach); }
  double high_seen(double x) const { return std::min(high, x + reach); }

  /// A place on it: uniform over the reach, or over the side if that is shorter; none if the other one excludes it.
  std::optional<double> place(double x, double number) const {
    const bool is_reach_shorter = 2 * reach < high - low;
    const double a = is_reach_shorter ? x + reach * (2 * number - 1) : low + (high - low) * number;
    if (a < low_seen(x) || a > high_seen(x)) return std::nullopt;
    return a;
  }
};

Side side_x(const Grid& panel, double reach) {
  return {panel.centre_x - panel.width() / 2, panel.centre_x + panel.width() / 2, reach};
}

Side side_y(const Grid& panel, double reach) {
  return {panel.centre_y - panel.height() / 2, panel.centre_y + panel.height() / 2, reach};
}

}  // namespace

bool PanelRays::Plane::is_crossed_at(Vec2 place) const {
  const Grid& grid = pixels.grid;
  return std::abs(place.x - grid.centre_x) <= grid.width() / 2 &&
         std::abs(place.y - grid.centre_y) <= grid.height() / 2;
}

PanelRays::PanelRays(const Grid& panel, double tangent, const std::vector<PixelPlane>& planes, int paths)
    : panel_(panel), tangent_(tangent), paths_(paths) {
  const auto density = [&](const PixelPlane& plane) {
    const double box = 2 * tangent * std::abs(plane.distance);
    const double area = std::min(panel.width(), box) * std::min(panel.height(), box);
    return plane.distance * plane.distance / (area * plane.grid.pitch * plane.grid.pitch);
  };
  for (const PixelPlane& plane : planes) planes_.push_back({plane, density(plane) / density(planes.front())});
}

std::optional<PanelRay> PanelRays::ray(int plane, Vec2 place, Vec2 numbers) const {
  const auto& [grid, distance] = planes_[size_t(plane)].pixels;
  const Vec2 target{grid.x(place.x - 0.5), grid.y(place.y - 0.5)};
  const auto x = side_x(panel_, tangent_ * std::abs(distance)).place(target.x, numbers.x);
  const auto y = side_y(panel_, tangent_ * std::abs(distance)).place(target.y, numbers.y);
  if (!x || !y) return std::nullopt;
  return PanelRay{{*x, *y}, {(target.x - *x) / distance, (target.y - *y) / distance}};
}

bool PanelRays::is_crossed_by_all(const Plane& plane, const Plane& other, int row, int column) const {
  const auto& [grid, distance] = plane.pixels;
  const Side across = side_x(panel_, tangent_ * std::abs(distance)), up = side_y(panel_, tangent_ * std::abs(distance));
  const double left = grid.x(column - 0.5), right = grid.x(column + 0.5);
  const double bottom = grid.y(row + 0.5), top = grid.y(row - 0.5);
  const double share = other.pixels.distance / distance;
  // A ray from a through x crosses the other plane at a·(1 − share) + x·share: the extremes are at the extreme a and x.
  for (const double a : {across.low_seen(left), across.high_seen(right)})
    for (const double x : {left, right})
      for (const double b : {up.low_seen(bottom), up.high_seen(top)})
        for (const double y : {bottom, top})
          if (!other.is_crossed_at({a + (x - a) * share, b + (y - b) * share})) return false;
  return true;
}

int PanelRays::candidates(int plane, int row, int column) const {
  const Plane& own = planes_[size_t(plane)];
  double least = 0;  // density that all rays of the pixel have already
  for (int i = 0; i < plane; ++i) {
    const Plane& other = planes_[size_t(i)];
    if (other.density > least && is_crossed_by_all(own, other, row, column)) least = other.density;
  }
  return int(std::ceil(paths_ * std::max(0.0, 1 - least / own.density) * (1 - 1e-12)));
}

double PanelRays::density_before(int plane, const PanelRay& ray) const {
  double density = 0;
  for (int i = 0; i < plane; ++i) {
    const Plane& other = planes_[size_t(i)];
    if (other.density > density && other.is_crossed_at(ray.at(other.pixels.distance))) density = other.density;
  }
  return density;
}

double PanelRays::keep_probability(int plane, const PanelRay& ray, int candidates) const {
  const double wanted = std::max(0.0, 1 - density_before(plane, ray) / planes_[size_t(plane)].density);
  return wanted * paths_ / candidates;
}

double PanelRays::weight(const PanelRay& ray) const { return 1 / density_before(int(planes_.size()), ray); }

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

void draw_points(const Accelerator& scene, const PanelPart& part, const PixelPlane& plane, double share,
                 Image& picture) {
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
    const double light = share * point_light(point, centre, part.panel, part.wavelength) / (side * side);
    for (const Share& row : down)
      for (const Share& column : across)
        for (int channel = 0; channel < picture.channels; ++channel)
          picture(row.pixel, column.pixel, channel) += float(light * row.light * column.light);
  }
}

}  // namespace holotrace
