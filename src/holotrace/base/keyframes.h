#pragma once

#include <cstddef>
#include <vector>

namespace holotrace {

/// How values change between two keys: on a straight line, on a smooth curve, or not at all until the next key.
enum class Interpolation { linear, smooth, step };

/// Values at given times. Each value is a list of numbers, which are interpolated one by one.
struct Keyframes {
  std::vector<double> times;                ///< [s], each later than the one before
  std::vector<std::vector<double>> values;  ///< one list for each time, all of the same length
  Interpolation interpolation = Interpolation::linear;
};

/// The key before a time, and the place of the time on the way to the next key.
struct KeyPlace {
  size_t key = 0;
  double part = 0;  ///< 0 at that key, 1 at the next one; 0 before the first and after the last key
};

/// @param times  at least one, each later than the one before
KeyPlace place_among(const std::vector<double>& times, double time);

/// The value at a time; before the first key it is the first value, after the last key the last.
///
/// A smooth curve is a cubic Hermite spline through the keys with the slopes of Fritsch and Butland: between two keys it never
/// leaves the interval of their values, it rests where two keys are equal, and it starts and ends at rest. Its slope is
/// continuous. Source: F. N. Fritsch and J. Butland, "A method for constructing local monotone piecewise cubic interpolants",
/// SIAM J. Sci. Stat. Comput. 5 (1984), 300–304, with the weights of their equation for unequal intervals.
std::vector<double> value_at(const Keyframes& keys, double time);

/// Cubic Hermite interpolation: values p and slopes m [per unit of t] at t = 0 and 1.
inline double hermite(double p0, double m0, double p1, double m1, double t) {
  const double t2 = t * t, t3 = t2 * t;
  return p0 + (3 * t2 - 2 * t3) * (p1 - p0) + (t3 - 2 * t2 + t) * m0 + (t3 - t2) * m1;  // exactly p0 at rest
}

}  // namespace holotrace
