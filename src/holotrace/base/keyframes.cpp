#include "holotrace/base/keyframes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace holotrace {
namespace {

// The slope of a smooth curve at key k, in one component: the weighted harmonic mean of the slopes on both sides, 0 where
// the value turns, at the first and at the last key.
double smooth_slope(const Keyframes& keys, size_t k, size_t component) {
  if (k == 0 || k + 1 == keys.times.size()) return 0;
  const double before = keys.times[k] - keys.times[k - 1], after = keys.times[k + 1] - keys.times[k];
  const double p = keys.values[k][component];
  const double slope_before = (p - keys.values[k - 1][component]) / before,
               slope_after = (keys.values[k + 1][component] - p) / after;
  if (!(slope_before * slope_after > 0)) return 0;
  const double weight_before = 2 * after + before, weight_after = after + 2 * before;
  return (weight_before + weight_after) / (weight_before / slope_before + weight_after / slope_after);
}

}  // namespace

KeyPlace place_among(const std::vector<double>& times, double time) {
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  if (next == times.begin()) return {0, 0};
  const auto key = size_t(next - times.begin()) - 1;
  if (next == times.end()) return {key, 0};
  return {key, (time - times[key]) / (times[key + 1] - times[key])};
}

std::vector<double> value_at(const Keyframes& keys, double time) {
  const auto [key, part] = place_among(keys.times, time);
  std::vector<double> value = keys.values[key];
  if (part == 0 || keys.interpolation == Interpolation::step) return value;
  const std::vector<double>& next = keys.values[key + 1];
  const double duration = keys.times[key + 1] - keys.times[key];
  for (size_t i = 0; i < value.size(); ++i)
    value[i] = keys.interpolation == Interpolation::linear
                   ? std::lerp(value[i], next[i], part)
                   : hermite(value[i], duration * smooth_slope(keys, key, i), next[i],
                             duration * smooth_slope(keys, key + 1, i), part);
  return value;
}

}  // namespace holotrace
