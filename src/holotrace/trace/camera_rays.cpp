#include "holotrace/trace/camera_rays.h"

#include <bit>

#include "holotrace/data/acceptance.h"

namespace holotrace {

PathScene make_path_scene(const Scene& scene, const RenderParams& params) {
  PathParams path_params;
  path_params.max_depth = params.max_depth;
  path_params.roulette_depth = params.roulette_depth;
  path_params.clamp = params.clamp;
  path_params.seed = uint64_t(params.seed);
  path_params.accelerator = params.accelerator;
  Lines lines;
  lines.glass_wavelength = params.glass_wavelength;
  return PathScene(scene, lines, params.path_expressions, path_params);
}

namespace {

Vec3 background_along(const PathScene& scene, const Ray& ray) {
  const int seen_path_groups = std::popcount(scene.automaton.accepted(scene.automaton.start()));
  return scene.emitters.background(ray.direction) * (seen_path_groups * scene.share_of_unpolarised());
}

}  // namespace

void radiance_along(const PathScene& scene, std::span<const NumberedRay> rays, bool has_background, int dimension,
                    LowDiscrepancy& numbers, std::span<Vec3> lights, PathCounts& counts) {
  uint32_t misses = find_radiance(scene, rays, dimension, numbers, lights, counts);
  for (; misses; misses &= misses - 1) {
    const auto i = size_t(std::countr_zero(misses));
    lights[i] = has_background ? lights[i] * background_along(scene, rays[i].ray) : Vec3{};
  }
}

double point_light(const ScenePoint& point, Vec3 place, const Grid& panel, double wavelength) {
  const Vec3 way = point.position - place;
  const double distance = length(way), cosine = way.z / distance, depth = std::abs(point.position.z);
  const double share = depth / distance;
  const double amplitude = point_amplitude(panel, wavelength, wavelength, depth) * point.amplitude;
  return amplitude * amplitude * share * share / (cosine * cosine * cosine * cosine);
}

}  // namespace holotrace
