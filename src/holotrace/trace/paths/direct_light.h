#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/paths/path_weights.h"
#include "holotrace/trace/paths/rectangle_samples.h"

// Sampling of the lights from a surface (formulas: path.h, add_radiance).

namespace holotrace {

/// A surface that a path has reached.
struct PathVertex {
  const SurfacePoint& point;
  Vec3 outgoing;  ///< unit, back along the path
  PathAutomaton::State state;
  int depth;  ///< surfaces so far, this one included
  Aim aim;    ///< how the point was found
  Vec3 throughput{1, 1, 1};
};

/// Adds the light that arrives at a surface straight from the lights, and what it reflects of that light, to a sink
/// (path_walk.h).
template <class Sink>
class DirectLight {
 public:
  DirectLight(const PathScene& scene, Sink& sink, PathCounts& counts) : scene_(scene), sink_(sink), counts_(counts) {}

  /// Each light is sampled once. The light is multiplied by `weight`.
  template <class B>
  void add(const B& bsdf, const PathVertex& at, double weight, LowDiscrepancy& numbers) {
    if (!begin(lobes(bsdf), at)) return;
    for_each_light(at, [&](const SampledLight& light, int, const auto& sample) {
      const LightSample way = sample(numbers);
      if (const auto reflected = reflect(bsdf, at, way, light.is_shared, weight))
        add_if_visible(at, way, light, *reflected);
    });
  }

  /// The sum of `add` with weight 1 over paths 0 … paths − 1 of the numbers, which reach the same surface and begin
  /// there. Shadow rays are traced together; one is enough for a light that always lies in the same direction.
  /// @return  number of dimensions that `add` takes of each path
  template <class B>
  int add_for_paths(const B& bsdf, const PathVertex& at, int paths, LowDiscrepancy& numbers) {
    static_assert(!Sink::follows_phase, "a phase needs the light of each path by itself");
    if (!begin(lobes(bsdf), at)) return 0;
    Waiting waiting;
    int taken = 0;
    for_each_light(at, [&](const SampledLight& light, int dimensions, const auto& sample) {
      if (dimensions == 0) {
        const LightSample way = sample(numbers);
        if (const auto reflected = reflect(bsdf, at, way, light.is_shared, paths))
          add_if_visible(at, way, light, *reflected);
        return;
      }
      if (const auto* surface = reflector(bsdf); surface && light.light && light.is_shared)
        return add_rectangle(*surface, at, light, {paths, taken++}, numbers);
      for (int path = 0; path < paths; ++path) {
        numbers.start(uint32_t(path));
        numbers.skip(taken);
        const LightSample way = sample(numbers);
        const auto reflected = reflect(bsdf, at, way, light.is_shared, 1);
        if (!reflected) continue;
        waiting.rays[waiting.count] = shadow_ray(at, way, light);
        waiting.reflected[waiting.count] = *reflected;
        if (++waiting.count < waiting.rays.size()) continue;
        add_visible(waiting, light.group);
        waiting.count = 0;
      }
      add_visible(waiting, light.group);
      waiting.count = 0;
      taken += dimensions;
    });
    return taken;
  }

 private:
  struct SampledLight {
    int group;
    bool is_shared;                ///< the path can also meet the light
    const Light* light = nullptr;  ///< none: meshes, or the environment
  };
  struct Reflected {
    Vec3 diffuse, glossy;
  };

  /// False if no path group accepts light of this surface.
  bool begin(LobeSet has, const PathVertex& at) {
    const PathAutomaton& automaton = scene_.automaton;
    diffuse_state_ = has.has_diffuse ? automaton.step(at.state, PathEvent::diffuse) : PathAutomaton::State{};
    glossy_state_ = has.has_glossy ? automaton.step(at.state, PathEvent::glossy) : PathAutomaton::State{};
    diffuse_path_groups_ = automaton.accepted(diffuse_state_);
    glossy_path_groups_ = automaton.accepted(glossy_state_);
    // Path groups that accept no light here may accept it behind a pane.
    return (diffuse_path_groups_ | glossy_path_groups_) || (scene_.has_panes && (diffuse_state_ | glossy_state_));
  }

  /// Calls visit(light, number of dimensions, sample), sample(numbers) being a LightSample.
  template <class Visit>
  void for_each_light(const PathVertex& at, const Visit& visit) const {
    const Emitters& emitters = scene_.emitters;
    const Vec3 from = at.point.position;
    const auto& lights = emitters.lights();
    for (size_t i = 0; i < lights.size(); ++i) {
      const bool is_shared = has_area(lights[i]);
      visit({int(i), is_shared, &lights[i]}, is_shared ? 1 : 0,
            [&](LowDiscrepancy& numbers) { return sample_light(lights[i], from, is_shared ? numbers.two() : Vec2{}); });
    }
    // Light of a mesh comes from a surface, which counts for max_depth.
    if (at.depth < scene_.params.max_depth && !emitters.triangles().is_empty())
      visit({emitters.mesh_group(), true}, 1,
            [&](LowDiscrepancy& numbers) { return emitters.triangles().sample(from, numbers.two()); });
    if (const EnvironmentLight* environment = emitters.environment())
      visit({emitters.background_group(), true}, 1,
            [&](LowDiscrepancy& numbers) { return environment->sample(numbers.two()); });
  }

  /// Paths pass through panes and meet all lights that can be met; only the other lights are sampled through panes.
  bool passes_panes(const SampledLight& light) const { return scene_.has_panes && !light.is_shared; }

  /// The light that the surface reflects to path groups, if nothing hides its source.
  template <class B>
  std::optional<Reflected> reflect(const B& bsdf, const PathVertex& at, const LightSample& way, bool is_shared,
                                   double weight) const {
    if (is_black(way.radiance) || !(way.pdf < most_light_density)) return std::nullopt;
    const auto of_lobe = [&](Lobe lobe) {
      const Vec3 f = eval(bsdf, at.outgoing, way.direction, lobe);
      if (is_black(f)) return Vec3{};
      // The weight over the density, p/(p² + p′²), without a separate division.
      const double other = is_shared ? pdf(bsdf, at.outgoing, way.direction, lobe) : 0;
      return at.throughput * f * way.radiance * (weight * way.pdf / (way.pdf * way.pdf + other * other));
    };
    const bool has_panes = scene_.has_panes && !is_shared;
    const Reflected light{diffuse_path_groups_ || (has_panes && diffuse_state_) ? of_lobe(Lobe::diffuse) : Vec3{},
                          glossy_path_groups_ || (has_panes && glossy_state_) ? of_lobe(Lobe::glossy) : Vec3{}};
    if (is_black(light.diffuse) && is_black(light.glossy)) return std::nullopt;
    return light;
  }

  void add_if_visible(const PathVertex& at, const LightSample& way, const SampledLight& light, Reflected reflected) {
    ++counts_.shadow_rays;
    uint32_t diffuse_path_groups = diffuse_path_groups_, glossy_path_groups = glossy_path_groups_;
    const ShadowRay ray = shadow_ray(at, way, light);
    if (scene_.accelerator.is_occluded(ray.ray, ray.distance, aim_at(at, light))) {
      const auto panes = passes_panes(light) ? panes_on(at, way) : std::nullopt;
      if (!panes) return;
      reflected.diffuse *= panes->share, reflected.glossy *= panes->share;
      diffuse_path_groups = path_groups_behind(panes->count, diffuse_state_);
      glossy_path_groups = path_groups_behind(panes->count, glossy_state_);
    }
    if (diffuse_path_groups) sink_.add(diffuse_path_groups, light.group, reflected.diffuse);
    if (glossy_path_groups) sink_.add(glossy_path_groups, light.group, reflected.glossy);
    if constexpr (Sink::follows_phase)
      sink_.end_way(light.light ? laser_path(*light.light, sink_.place_of_phase(at.point.position)) : std::nullopt);
  }

  static Aim aim_at(const PathVertex& at, const SampledLight& light) { return light.is_shared ? Aim::random : at.aim; }

  /// The surface, if it is diffuse and only reflects; else none.
  static const DiffuseBsdf* reflector(const DiffuseBsdf& b) { return b.transmission_probability == 0 ? &b : nullptr; }
  template <class B>
  static const DiffuseBsdf* reflector(const B&) {
    return nullptr;
  }

  struct PathsAtDimension {
    int paths, dimension;
  };

  /// The light of a rectangle on such a surface, for all paths: 16 of them together.
  void add_rectangle(const DiffuseBsdf& bsdf, const PathVertex& at, const SampledLight& light,
                     const PathsAtDimension& numbered, const LowDiscrepancy& numbers) {
    const auto& rectangle = std::get<RectangleLight>(*light.light);
    const Vec3 from = at.point.position, brightness = at.throughput * bsdf.reflectance * rectangle.radiance;
    if (!diffuse_path_groups_ || is_black(brightness)) return;
    const RectangleAndSurface pair{.corner = rectangle.corner - from,
                                   .edge_u = rectangle.edge_u,
                                   .edge_v = rectangle.edge_v,
                                   .is_visible = rectangle.is_visible,
                                   .lift = scene_.accelerator.lift_of(light.group),
                                   .normal = bsdf.normal,
                                   .geometric_normal = at.point.geometric_normal,
                                   .clearance = at.point.clearance,
                                   .centre = scene_.accelerator.precision().centre - from};
    const Vec3 start = scene_.accelerator.leave(at.point, at.point.geometric_normal);
    double sum = 0;
    for (int first = 0; first < numbered.paths; first += most_shadow_rays) {
      const LowDiscrepancy::Block places = numbers.two_of_block(uint32_t(first / most_shadow_rays), numbered.dimension);
      RectangleSamples samples;
      sample_rectangle(pair, places.x.data(), places.y.data(), samples);
      std::array<ShadowRay, most_shadow_rays> rays;
      std::array<double, most_shadow_rays> shares;
      size_t count = 0;
      for (size_t i = 0; i < size_t(std::min(most_shadow_rays, numbered.paths - first)); ++i) {
        if (!(samples.share[i] > 0)) continue;
        rays[count] = {{start, {samples.x[i], samples.y[i], samples.z[i]}}, samples.distance[i]};
        shares[count++] = samples.share[i];
      }
      if (count == 0) continue;
      counts_.shadow_rays += int64_t(count);
      const uint32_t occluded = scene_.accelerator.occluded({rays.data(), count}, Aim::random);
      for (size_t i = 0; i < count; ++i)
        if (!(occluded >> i & 1)) sum += shares[i];
    }
    sink_.add(diffuse_path_groups_, light.group, brightness * sum);
  }

  /// Light that can be met, until its shadow rays are traced together.
  struct Waiting {
    std::array<ShadowRay, most_shadow_rays> rays;
    std::array<Reflected, most_shadow_rays> reflected;
    size_t count = 0;
  };

  void add_visible(const Waiting& waiting, int group) {
    if (waiting.count == 0) return;
    counts_.shadow_rays += int64_t(waiting.count);
    const uint32_t occluded = scene_.accelerator.occluded({waiting.rays.data(), waiting.count}, Aim::random);
    Reflected sum;
    for (size_t i = 0; i < waiting.count; ++i)
      if (!(occluded >> i & 1)) {
        sum.diffuse += waiting.reflected[i].diffuse;
        sum.glossy += waiting.reflected[i].glossy;
      }
    if (diffuse_path_groups_) sink_.add(diffuse_path_groups_, group, sum.diffuse);
    if (glossy_path_groups_) sink_.add(glossy_path_groups_, group, sum.glossy);
  }

  /// From the surface to the light. The surface of a light is moved toward rays (Accelerator::lift_of).
  ShadowRay shadow_ray(const PathVertex& at, const LightSample& way, const SampledLight& light) const {
    const Vec3 from = scene_.accelerator.leave(at.point, way.direction);
    // The ray starts off the surface, up to a clearance nearer to the light.
    if (way.cosine == 0) return {{from, way.direction}, way.distance - at.point.clearance};
    // The emitting surface itself is in the way: the ray ends before its plane, at grazing angles
    // sooner.
    const ScenePrecision& precision = scene_.accelerator.precision();
    const Vec3 end = at.point.position + way.direction * way.distance, rest = end - from;
    const double distance = length(rest), lift = light.light ? scene_.accelerator.lift_of(light.group) : 0;
    // No corner of the emitting surface is farther from the centre than this.
    const double of_light = light_rounding * (length(end - precision.centre) + way.size);
    return {{from, rest * (1 / distance)}, distance - (lift + of_light) / std::max(way.cosine, least_light_cosine)};
  }

  /// The panes between the point and a light, if there is nothing else and the path may be that long.
  struct Panes {
    int count = 0;
    Vec3 share{1, 1, 1};  // fraction of the light that they transmit
  };

  std::optional<Panes> panes_on(const PathVertex& at, const LightSample& way) {
    Ray ray{scene_.accelerator.leave(at.point, way.direction), way.direction};
    double left = way.distance - 2 * at.point.clearance;  // as in shadow_ray
    for (Panes panes; at.depth + panes.count <= scene_.params.max_depth; ++panes.count) {
      ++counts_.rays;
      const auto hit = scene_.accelerator.closest_hit(ray);
      if (!hit || hit->distance >= left) return panes;
      const Material& material = material_at(scene_.scene, hit->point);
      if (!is_pane(material)) return std::nullopt;
      const Bsdf pane = make_bsdf(material, shading_point(material, hit->point), scene_.lines);
      const SpecularBranches branches = specular_branches(pane, -way.direction);
      const auto last = branches.ways.begin() + branches.count;
      const auto straight =
          std::find_if(branches.ways.begin(), last, [](const BsdfSample& branch) { return branch.is_transmission; });
      if (straight == last) return std::nullopt;
      panes.share *= straight->weight;
      const Vec3 next = scene_.accelerator.leave(hit->point, way.direction);
      left -= dot(next - ray.origin, way.direction);
      ray.origin = next;
    }
    return std::nullopt;
  }

  /// The path groups that accept light which passed panes on its way to the surface; the path left it in `state`.
  uint32_t path_groups_behind(int panes, PathAutomaton::State state) const {
    for (; panes > 0; --panes) state = scene_.automaton.step(state, PathEvent::specular);
    return scene_.automaton.accepted(state);
  }

  const PathScene& scene_;
  Sink& sink_;
  PathCounts& counts_;
  PathAutomaton::State diffuse_state_ = 0, glossy_state_ = 0;  // after these lobes of the surface; 0: no such lobe
  uint32_t diffuse_path_groups_ = 0, glossy_path_groups_ = 0;  // that accept light by these lobes
};

}  // namespace holotrace
