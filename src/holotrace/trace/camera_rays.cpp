#include "holotrace/trace/camera_rays.h"

#include <algorithm>
#include <array>
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

namespace {

/// The first surface on a ray, where its path starts; false if there is none.
bool find_start(const PathScene& scene, const Ray& ray, PathStart& start) {
  Hit hit;
  if (!scene.accelerator.closest_hit(ray, hit, Aim::random)) return false;
  const Material& material = material_at(scene.scene, hit.point);
  start = {material.normal_map ? shading_point(material, hit.point) : hit.point, -ray.direction,
           scene.automaton.start()};
  start.aim = Aim::random;
  return true;
}

Vec3 background_along(const PathScene& scene, const Ray& ray) {
  const int seen_path_groups = std::popcount(scene.automaton.accepted(scene.automaton.start()));
  return scene.emitters.background(ray.direction) * seen_path_groups;
}

Vec3 sum_of(std::span<const Vec3> sums) {
  Vec3 sum;
  for (const Vec3& of_group : sums) sum += of_group;
  return sum;
}

}  // namespace

Vec3 radiance_along(const PathScene& scene, const Ray& ray, bool has_background, LowDiscrepancy& numbers,
                    std::span<Vec3> sums, PathCounts& counts) {
  ++counts.rays;
  PathStart start;
  if (!find_start(scene, ray, start)) return has_background ? background_along(scene, ray) : Vec3{};
  std::fill(sums.begin(), sums.end(), Vec3{});
  add_radiance(scene, start, numbers, sums, counts);
  return sum_of(sums);
}

Vec3 radiance_along(const PathScene& scene, std::span<const CameraRay> rays, bool has_background, int dimension,
                    LowDiscrepancy& numbers, std::span<Vec3> sums, PathCounts& counts) {
  counts.rays += int64_t(rays.size());
  Vec3 beyond;
  std::array<NumberedStart, most_together> starts;
  size_t count = 0;
  for (const auto& [ray, path] : rays) {
    starts[count].path = path;
    if (find_start(scene, ray, starts[count].start))
      ++count;
    else if (has_background)
      beyond += background_along(scene, ray);
  }
  if (count == 0) return beyond;
  std::fill(sums.begin(), sums.end(), Vec3{});
  add_radiance(scene, {starts.data(), count}, dimension, numbers, sums, counts);
  return beyond + sum_of(sums);
}

double point_light(const ScenePoint& point, Vec3 place, const Grid& panel, double wavelength) {
  const Vec3 way = point.position - place;
  const double distance = length(way), cosine = -way.z / distance, share = -point.position.z / distance;
  const double amplitude = point_amplitude(panel, wavelength, wavelength, -point.position.z) * point.amplitude;
  return amplitude * amplitude * share * share / (cosine * cosine * cosine * cosine);
}

}  // namespace holotrace
