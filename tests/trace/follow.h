#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "holotrace/trace/paths/path.h"
#include "trace/scenes.h"

// Single light paths in tests.

namespace holotrace {

inline constexpr int unlimited = 100000;  // number of surfaces; roulette ends every path long before

/// Where a ray meets a scene.
inline PathStart start_of(const PathScene& scene, const Ray& ray) {
  const auto hit = scene.accelerator.closest_hit(ray);
  EXPECT_TRUE(hit.has_value());
  return {hit.value().point, -ray.direction, scene.automaton.start(), 1};
}

/// Radiance of single independent paths from the first hit of a ray, in red, green and blue.
inline std::vector<Vec3> radiances(const Scene& scene, const Ray& ray, int count, const PathParams& params,
                                   PathCounts& counts) {
  const PathScene path_scene(scene, Lines{}, {}, params);
  const PathStart start = start_of(path_scene, ray);
  std::vector<Vec3> all;
  for (int i = 0; i < count; ++i) mean_radiance(path_scene, start, 1, uint64_t(i), {&all.emplace_back(), 1}, counts);
  return all;
}

inline std::vector<Vec3> radiances(const Scene& scene, const Ray& ray, int count, int max_depth, PathCounts& counts) {
  return radiances(scene, ray, count, {.max_depth = max_depth}, counts);
}

/// Statistics of the green channel of `radiances`.
inline Statistics follow(const Scene& scene, const Ray& ray, int count, const PathParams& params, PathCounts& counts) {
  Statistics statistics;
  for (const Vec3 radiance : radiances(scene, ray, count, params, counts)) statistics.add(radiance.y);
  return statistics;
}

inline Statistics follow(const Scene& scene, const Ray& ray, int count, int max_depth, PathCounts& counts) {
  return follow(scene, ray, count, {.max_depth = max_depth}, counts);
}

inline Statistics follow(const Scene& scene, const Ray& ray, int count, int max_depth) {
  PathCounts counts;
  return follow(scene, ray, count, max_depth, counts);
}

/// The green channel of each sum: the mean of `paths` paths of sample 0.
inline std::vector<double> sums_of(const Scene& scene, const Ray& ray, const std::vector<std::string>& path_groups,
                                   const PathParams& params, int paths) {
  const PathScene path_scene(scene, Lines{}, path_groups, params);
  std::vector<Vec3> sums(size_t(path_scene.sums()));
  PathCounts counts;
  mean_radiance(path_scene, start_of(path_scene, ray), paths, 0, sums, counts);
  std::vector<double> green;
  for (const Vec3 sum : sums) green.push_back(sum.y);
  return green;
}

/// View factor from a small plane patch to a parallel rectangle a × b at distance c, with one corner
/// directly above the patch (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3).
inline double corner_view_factor(double a, double b, double c) {
  const double x = a / c, y = b / c, sx = std::sqrt(1 + x * x), sy = std::sqrt(1 + y * y);
  return (x / sx * std::atan(y / sx) + y / sy * std::atan(x / sy)) / (2 * pi);
}

}  // namespace holotrace
