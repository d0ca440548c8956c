#include "holotrace/trace/path.h"

#include <fmt/format.h>

#include "holotrace/trace/light.h"

namespace holotrace {

namespace {

Vec3 multiply(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

bool is_black(Vec3 v) { return v.x <= 0 && v.y <= 0 && v.z <= 0; }

/// Light of all lights that a surface sends back, by one shadow ray to each.
Vec3 direct_light(const Accelerator& scene, const Material& material, const SurfacePoint& point, CounterRandom& random,
                  PathCounts& counts) {
  Vec3 sum;
  for (const Light& light : scene.scene().lights) {
    const double u = random.uniform(), v = random.uniform();
    const LightSample way = sample_light(light, point.position, u, v);
    if (is_black(way.radiance)) continue;
    const Vec3 reflected = multiply(eval_material(material, point, way.direction), way.radiance) / way.pdf;
    if (is_black(reflected)) continue;
    ++counts.shadow_rays;
    if (!scene.is_occluded(scene.leave(point), way.position)) sum += reflected;
  }
  return sum;
}

}  // namespace

PathCounts& PathCounts::operator+=(const PathCounts& other) {
  paths += other.paths;
  vertices += other.vertices;
  rays += other.rays;
  shadow_rays += other.shadow_rays;
  escaped += other.escaped;
  absorbed += other.absorbed;
  cut += other.cut;
  return *this;
}

void report(const PathCounts& counts, int max_depth, const Observer& observer) {
  observer.fact("rays", Fact(counts.rays));
  observer.fact("shadow_rays", Fact(counts.shadow_rays));
  observer.fact("paths", Fact(counts.paths));
  observer.fact("mean_path_length", Fact(counts.mean_path_length()));
  observer.fact("escaped", Fact(counts.escaped));
  observer.fact("absorbed", Fact(counts.absorbed));
  observer.fact("cut", Fact(counts.cut));
  // A cut path still had the light of its first max_depth surfaces: below 5 % the loss is not seen.
  constexpr double visible = 0.05;
  if (double(counts.cut) > visible * double(counts.paths))
    observer.warn(
        fmt::format("{:.0f} % of the light paths were cut after {} surfaces, which darkens corners and "
                    "interiors; raise max_depth",
                    100.0 * double(counts.cut) / double(counts.paths), max_depth));
}

Vec3 path_radiance(const Accelerator& scene, const SurfacePoint& first, int max_depth, CounterRandom& random,
                   PathCounts& counts) {
  ++counts.paths;
  Vec3 radiance, throughput{1, 1, 1};
  SurfacePoint point = first;
  for (int depth = 1;; ++depth) {
    ++counts.vertices;
    const Material& material = scene.scene().materials[size_t(point.material)];
    radiance += multiply(throughput, eval_emission(material) + direct_light(scene, material, point, random, counts));

    const MaterialSample next = sample_material(material, point, random);
    throughput = multiply(throughput, next.weight);
    const double goes_on = max_component(throughput);
    if (!(random.uniform() < goes_on)) {
      ++counts.absorbed;
      return radiance;
    }
    if (depth >= max_depth) {
      ++counts.cut;
      return radiance;
    }
    throughput = throughput / goes_on;

    ++counts.rays;
    const auto hit = scene.closest_hit({scene.leave(point), next.direction});
    if (!hit) {
      ++counts.escaped;
      return radiance + multiply(throughput, scene.scene().background);
    }
    point = hit->point;
  }
}

Vec3 mean_path_radiance(const Accelerator& scene, const SurfacePoint& first, int paths, int max_depth,
                        CounterRandom& random, PathCounts& counts) {
  Vec3 sum;
  for (int path = 0; path < paths; ++path) sum += path_radiance(scene, first, max_depth, random, counts);
  return sum / paths;
}

}  // namespace holotrace
