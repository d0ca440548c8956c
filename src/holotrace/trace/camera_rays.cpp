#include "holotrace/trace/camera_rays.h"

#include <algorithm>
#include <bit>

#include "holotrace/data/point_strength.h"
#include "holotrace/trace/materials/bsdf.h"

namespace holotrace {

PathScene make_path_scene(const Scene& scene, const RenderParams& params) {
  PathParams path_params;
  path_params.max_depth = params.max_depth;
  path_params.roulette_depth = params.roulette_depth;
  path_params.clamp = params.clamp;
  path_params.seed = uint64_t(params.seed);
  path_params.accelerator = params.accelerator;
  return PathScene(scene, Lines{}, params.path_expressions, path_params);
}

Vec3 radiance_along(const PathScene& scene, const Ray& ray, bool has_background, LowDiscrepancy& numbers,
                    std::span<Vec3> sums, PathCounts& counts) {
  ++counts.rays;
  Hit hit;
  if (!scene.accelerator.closest_hit(ray, hit, Aim::random)) {
    if (!has_background) return {};
    const int seen_path_groups = std::popcount(scene.automaton.accepted(scene.automaton.start()));
    return scene.emitters.background(ray.direction) * seen_path_groups;
  }
  const Material& material = material_at(scene.scene, hit.point);
  PathStart start{material.normal_map ? shading_point(material, hit.point) : hit.point, -ray.direction,
                  scene.automaton.start()};
  start.aim = Aim::random;
  std::fill(sums.begin(), sums.end(), Vec3{});
  add_radiance(scene, start, numbers, sums, counts);
  Vec3 sum;
  for (const Vec3 of_group : sums) sum += of_group;
  return sum;
}

double point_light(const ScenePoint& point, Vec3 place, const Grid& panel, double wavelength) {
  const Vec3 way = point.position - place;
  const double distance = length(way), cosine = -way.z / distance, share = -point.position.z / distance;
  const double amplitude = point_amplitude(panel, wavelength, wavelength, -point.position.z) * point.amplitude;
  return amplitude * amplitude * share * share / (cosine * cosine * cosine * cosine);
}

}  // namespace holotrace
