#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

namespace holotrace {

/// The part of a light source that one illumination state represents; directions are angles [rad] from that state's
/// own point. The source is a disc, represented by a set of points. A part has the directions that are nearest to its
/// own point, so the parts together cover the disc without overlap.
struct SourcePart {
  using Points = std::vector<std::array<double, 2>>;

  double angle = 0;                        ///< full angle of the disc; 0: a point source
  std::shared_ptr<const Points> points{};  ///< angles from the centre of the disc [rad]; none: the centre alone
  size_t own = 0;                          ///< index of this part's own point

  size_t count() const { return points ? points->size() : 1; }
  std::array<double, 2> place() const { return points ? (*points)[own] : std::array<double, 2>{}; }

  /// Whether the part's own point is the nearest one to the direction (x, y) [rad] from the disc's centre. Of points at
  /// the same distance the first one counts, so exactly one part has each direction.
  bool is_nearest(double x, double y) const {
    const auto squared = [&](size_t i) {
      const double dx = x - (*points)[i][0], dy = y - (*points)[i][1];
      return dx * dx + dy * dy;
    };
    if (count() < 2) return true;
    const double own_squared = squared(own);
    for (size_t i = 0; i < count(); ++i) {
      const double other = squared(i);
      if (other < own_squared || (other == own_squared && i < own)) return false;
    }
    return true;
  }

  /// Whether the direction (x, y) [rad] from the part's own point is in the part.
  bool holds(double x, double y) const {
    const auto [x0, y0] = place();
    return std::hypot(x0 + x, y0 + y) <= angle / 2 && is_nearest(x0 + x, y0 + y);
  }

  /// Upper bound of the angle between the part's own point and a direction in the part [rad].
  double reach() const {
    if (count() < 2) return angle / 2 + std::hypot(place()[0], place()[1]);
    constexpr int steps = 64;
    const double step = angle / steps;
    double farthest = 0;
    for (int j = 0; j <= steps; ++j)
      for (int i = 0; i <= steps; ++i) {
        const double x = (i - steps / 2) * step - place()[0], y = (j - steps / 2) * step - place()[1];
        if (holds(x, y)) farthest = std::max(farthest, std::hypot(x, y));
      }
    return std::min(farthest + 2 * step, angle);  // a corner may lie between the steps
  }
};

}  // namespace holotrace
