#pragma once

#include <algorithm>
#include <cmath>

#include "holotrace/base/units.h"

namespace holotrace {

/// Area of the unit disc where x < u: ∫ 2√(1 − x²) dx from −1 to u, for −1 ≤ u ≤ 1.
inline double disc_area_below(double u) { return pi / 2 + u * std::sqrt((1 - u) * (1 + u)) + std::asin(u); }

/// Area of the unit disc where x < u and y < v, for −1 ≤ u, v ≤ 1. With c = √(1 − v²), the strip at x has the length
/// √(1 − x²) + v for |x| ≤ c; beyond, 2√(1 − x²) for v > 0, and 0 for v < 0.
inline double disc_area_below(double u, double v) {
  const double c = std::sqrt((1 - v) * (1 + v));
  const double end = std::clamp(u, -c, c);
  // ∫ √(1 − x²) dx from −c to end, half of what lies on both sides of the axis
  const double half = (disc_area_below(end) - disc_area_below(-c)) / 2;
  const double inside = half + v * (end + c);
  if (v <= 0) return inside;
  const double left = disc_area_below(std::min(u, -c)), right = u > c ? disc_area_below(u) - disc_area_below(c) : 0.0;
  return left + inside + right;
}

}  // namespace holotrace
