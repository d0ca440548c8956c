#include "holotrace/trace/path.h"

#include <fmt/format.h>

#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/trace/bsdf.h"
#include "holotrace/trace/light.h"

namespace holotrace {

namespace {

bool is_black(Vec3 v) { return v.x <= 0 && v.y <= 0 && v.z <= 0; }

void add(const PathScene& scene, uint32_t layers, int group, Vec3 radiance, std::span<Vec3> sums) {
  const int count = scene.automaton.layers(), first = scene.params.separate_lights ? group * count : 0;
  for (int layer = 0; layer < count; ++layer)
    if (layers >> layer & 1) sums[size_t(first + layer)] += radiance;
}

/// Light of all lights that a surface sends back, by one shadow ray to each.
void add_direct_light(const PathScene& scene, const Bsdf& bsdf, const SurfacePoint& point, Vec3 outgoing,
                      Vec3 throughput, PathAutomaton::State state, LowDiscrepancy& numbers, std::span<Vec3> sums,
                      PathCounts& counts) {
  const auto& lights = scene.scene.lights;
  for (size_t i = 0; i < lights.size(); ++i) {
    const Vec2 u = numbers.two();
    const LightSample way = sample_light(lights[i], point.position, u.x, u.y);
    if (is_black(way.radiance)) continue;
    const Vec3 reflected =
        eval_bsdf(bsdf, outgoing, way.direction, Lobe::diffuse) * scene.lines.from_rgb(way.radiance) / way.pdf;
    if (is_black(reflected)) continue;
    ++counts.shadow_rays;
    if (scene.accelerator.is_occluded(scene.accelerator.leave(point), way.position)) continue;
    const auto event = scene.automaton.step(state, PathEvent::diffuse);
    add(scene, scene.automaton.accepted(event), int(i), throughput * reflected, sums);
  }
}

PathEvent event_of(Lobe lobe) {
  return lobe == Lobe::diffuse ? PathEvent::diffuse : lobe == Lobe::glossy ? PathEvent::glossy : PathEvent::specular;
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

PathScene::PathScene(const Scene& scene, const Lines& lines, const std::vector<std::string>& layers,
                     const PathParams& params)
    : scene(scene), accelerator(scene), emitters(scene, lines), automaton(layers), lines(lines), params(params) {
  require(params.max_depth >= 1, "expected a max_depth of 1 surface or more, got {}", params.max_depth);
}

void add_radiance(const PathScene& scene, const PathStart& start, LowDiscrepancy& numbers, std::span<Vec3> sums,
                  PathCounts& counts) {
  ++counts.paths;
  Vec3 throughput{1, 1, 1}, outgoing = start.outgoing;
  SurfacePoint point = start.point;
  PathAutomaton::State state = start.state;
  for (int depth = start.depth;; ++depth) {
    ++counts.vertices;
    const Material& material = scene.scene.materials[size_t(point.material)];
    const Bsdf bsdf = make_bsdf(material, point, scene.lines);
    add(scene, scene.automaton.accepted(state), scene.emitters.mesh_group(),
        throughput * emitted_radiance(material, point, scene.lines), sums);
    add_direct_light(scene, bsdf, point, outgoing, throughput, state, numbers, sums, counts);

    const double u_lobe = numbers.one();
    const auto next = sample_bsdf(bsdf, outgoing, u_lobe, numbers.two());
    if (next) throughput *= next->weight;
    const double goes_on = next ? max_component(throughput) : 0;
    if (!(numbers.one() < goes_on)) {
      ++counts.absorbed;
      return;
    }
    if (depth >= scene.params.max_depth) {
      ++counts.cut;
      return;
    }
    throughput = throughput / goes_on;
    state = scene.automaton.step(state, event_of(next->lobe));

    ++counts.rays;
    const auto hit = scene.accelerator.closest_hit({scene.accelerator.leave(point), next->direction});
    if (!hit) {
      ++counts.escaped;
      add(scene, scene.automaton.accepted(state), scene.emitters.background_group(),
          throughput * scene.emitters.background(next->direction), sums);
      return;
    }
    point = hit->point;
    outgoing = -next->direction;
  }
}

void mean_radiance(const PathScene& scene, const PathStart& start, int paths, uint64_t sample, std::span<Vec3> sums,
                   PathCounts& counts) {
  std::fill(sums.begin(), sums.end(), Vec3{});
  LowDiscrepancy numbers(scene.params.seed, 0, sample);
  for (int path = 0; path < paths; ++path) {
    numbers.start(uint32_t(path));
    add_radiance(scene, start, numbers, sums, counts);
  }
  for (Vec3& sum : sums) sum = sum / paths;
}

}  // namespace holotrace
