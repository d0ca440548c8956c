#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "holotrace/base/vec.h"

// Quantities of several paths side by side, for vector instructions.

namespace holotrace {

inline constexpr int most_together = 16;  ///< paths that are followed together, and rays that are traced together

/// A number of each path. Numbers of paths that are not there are not set.
using Lane = std::array<double, most_together>;

/// Lengths of rays without end.
inline constexpr Lane without_end = [] {
  Lane lengths{};
  lengths.fill(std::numeric_limits<double>::infinity());
  return lengths;
}();

/// A vector of each path.
struct LaneVectors {
  Lane x, y, z;

  void set(size_t i, Vec3 v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
  void fill(Vec3 v) { x.fill(v.x), y.fill(v.y), z.fill(v.z); }
  Vec3 operator[](size_t i) const { return {x[i], y[i], z[i]}; }
};

/// A ray of each path, and the length of it that matters.
struct RayLanes {
  const LaneVectors& origin;     ///< [m]
  const LaneVectors& direction;  ///< unit
  const Lane& distance;          ///< [m], may be infinite
};

}  // namespace holotrace
