#include "holotrace/trace/panel_rays.h"

#include <algorithm>
#include <cmath>

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

}  // namespace holotrace
