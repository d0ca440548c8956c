#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <variant>

#include "holotrace/trace/geometry/light_surfaces.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/paths/path.h"
#include "holotrace/trace/paths/path_weights.h"

// The one loop along a light path (formulas: path.h, add_radiance). The light found goes to a Sink:
//
//   static constexpr bool follows_phase        whether start, scatter and travel are called
//   add(path_groups, group, radiance)               light of a group for the path groups whose bits are set
//   end_way(laser_path)                        all light of one contribution was added; for a laser: its optical path
//                                              from there to the surface, else none
//   start(start), scatter(point, sample), travel(distance)   the path begins, leaves a surface, reaches the next one
//   place_of_phase(point)                      place on that surface at which the phase of light is evaluated

namespace holotrace {

template <class Sink>
class PathWalk {
 public:
  PathWalk(const PathScene& scene, Sink& sink, PathCounts& counts)
      : scene_(scene), automaton_(scene.automaton), emitters_(scene.emitters), sink_(sink), counts_(counts) {}

  void follow(const PathStart& start, LowDiscrepancy& numbers) {
    ++counts_.paths;
    state_ = start.state;
    point_ = start.point;
    outgoing_ = start.outgoing;
    if (point_.light >= 0) {
      add_lamp();
      return;
    }
    if constexpr (Sink::follows_phase) sink_.start(start);
    for (depth_ = start.depth;; ++depth_) {
      ++counts_.vertices;
      const Material& material = scene_.scene.materials[size_t(point_.material)];
      if (emitters_.is_emissive(point_.material)) add_emission(material);
      const Bsdf bsdf = make_bsdf(material, point_, scene_.lines);
      // One visit per surface: inside it the functions of this kind of surface are called directly.
      const auto next = std::visit([&](const auto& b) { return scatter(b, numbers); }, bsdf);
      if (!next || !leave(*next)) return;
    }
  }

  /// Adds light on a ray before `distance` and not on a surface. The path came in `state` with density `pdf` [1/sr]; 0
  /// means by a specular branch.
  void add_light_on_way(const Ray& ray, double distance, PathAutomaton::State state, double pdf, Vec3 throughput) {
    const uint32_t path_groups = automaton_.accepted(state);
    if (!path_groups) return;
    for (const int i : emitters_.lights_on_way()) {
      const auto& light = std::get<RectangleLight>(emitters_.lights()[size_t(i)]);
      const auto met = meet(light, ray);
      if (!met || met->distance >= distance) continue;
      add_met(path_groups, i, throughput * light.radiance * (pdf > 0 ? shared_weight(pdf, met->pdf) : 1));
    }
    if (distance < std::numeric_limits<double>::infinity()) return;
    Vec3 radiance = emitters_.even_background();
    if (const EnvironmentLight* environment = emitters_.environment())
      radiance +=
          environment->radiance(ray.direction) * (pdf > 0 ? shared_weight(pdf, environment->pdf(ray.direction)) : 1);
    add_met(path_groups, emitters_.background_group(), throughput * radiance);
  }

 private:
  void add_met(uint32_t path_groups, int group, Vec3 light) {
    if (is_black(light)) return;
    sink_.add(path_groups, group, light);
    sink_.end_way(std::nullopt);
  }

  /// Adds the emission of the surface itself.
  void add_emission(const Material& material) {
    const uint32_t path_groups = automaton_.accepted(state_);
    if (!path_groups) return;
    Vec3 light = throughput_ * emitted_radiance(material, point_, scene_.lines);
    if (pdf_ > 0) {
      const double cosine = std::abs(dot(point_.geometric_normal, outgoing_));
      light *= shared_weight(pdf_, emitters_.triangles().pdf(point_.mesh, point_.triangle, distance_, cosine));
    }
    add_met(path_groups, emitters_.mesh_group(), light);
  }

  /// Adds the light of a visible rectangle at whose surface the path ends. As for other lights, its surface does not
  /// count for max_depth.
  void add_lamp() {
    ++counts_.absorbed;
    const uint32_t path_groups = automaton_.accepted(state_);
    if (!path_groups || !point_.is_front) return;
    const auto& light = std::get<RectangleLight>(emitters_.lights()[size_t(point_.light)]);
    const double cosine = std::abs(dot(point_.geometric_normal, outgoing_));
    add_met(path_groups, point_.light,
            throughput_ * light.radiance * (pdf_ > 0 ? shared_weight(pdf_, pdf(light, distance_, cosine)) : 1));
  }

  /// Samples the lights, and draws how the path continues; no result if it ends.
  template <class B>
  std::optional<BsdfSample> scatter(const B& bsdf, LowDiscrepancy& numbers) {
    const LobeSet has = lobes(bsdf);
    const bool asks_at_end = scene_.params.asks_at_end && depth_ < scene_.params.max_depth;
    if (!asks_at_end) add_direct_light(bsdf, numbers, has, 1);
    const Vec2 choices = numbers.two(), u = numbers.two();  // for the lobe, and for roulette
    const Vec3 before = throughput_;
    auto next = sample(bsdf, outgoing_, choices.x, u);
    if (next) {
      throughput_ *= next->weight;
      scale_ *= next->squared_index_ratio;
    }
    // Radiance is n² times as large inside glass without being more light: roulette divides that out.
    double goes_on = next ? std::min(1.0, max_component(throughput_) / scale_) : 0;
    constexpr double most = 0.9;  // keeps the weight of light at rare ends small
    if (asks_at_end && (has.has_diffuse || has.has_glossy)) goes_on = std::min(goes_on, most);
    if (!(choices.y < goes_on)) {
      ++counts_.absorbed;
      throughput_ = before;
      if (asks_at_end) add_direct_light(bsdf, numbers, has, 1 / (1 - goes_on));
      return std::nullopt;
    }
    throughput_ *= 1 / goes_on;
    return next;
  }

  /// Samples the lights; their light is multiplied by `weight`.
  template <class B>
  void add_direct_light(const B& bsdf, LowDiscrepancy& numbers, LobeSet has, double weight) {
    direct_weight_ = weight;
    diffuse_state_ = has.has_diffuse ? automaton_.step(state_, PathEvent::diffuse) : PathAutomaton::State{};
    glossy_state_ = has.has_glossy ? automaton_.step(state_, PathEvent::glossy) : PathAutomaton::State{};
    diffuse_path_groups_ = automaton_.accepted(diffuse_state_);
    glossy_path_groups_ = automaton_.accepted(glossy_state_);
    // Path groups that accept no light here may accept it behind a pane.
    if (!(diffuse_path_groups_ | glossy_path_groups_) && !(scene_.has_panes && (diffuse_state_ | glossy_state_)))
      return;
    const auto& lights = emitters_.lights();
    for (size_t i = 0; i < lights.size(); ++i) {
      const bool is_shared = has_area(lights[i]);
      add_way(bsdf, sample_light(lights[i], point_.position, is_shared ? numbers.two() : Vec2{}), is_shared, int(i),
              &lights[i]);
    }
    // Light of a mesh comes from a surface, which counts for max_depth.
    if (depth_ < scene_.params.max_depth && !emitters_.triangles().is_empty()) {
      const double u = numbers.one();
      add_way(bsdf, emitters_.triangles().sample(point_.position, u, numbers.two()), true, emitters_.mesh_group());
    }
    if (const EnvironmentLight* environment = emitters_.environment())
      add_way(bsdf, environment->sample(numbers.two()), true, emitters_.background_group());
  }

  /// Adds the light of one sample of a light; `is_shared` if the path can also meet the light.
  template <class B>
  void add_way(const B& bsdf, const LightSample& way, bool is_shared, int group, const Light* light = nullptr) {
    constexpr double most = 1e150;  // its square is finite; such light arrives at a vanishing angle to its surface
    if (is_black(way.radiance) || !(way.pdf < most)) return;
    const auto reflected = [&](Lobe lobe) {
      const Vec3 f = eval(bsdf, outgoing_, way.direction, lobe);
      if (is_black(f)) return Vec3{};
      // The weight over the density, p/(p² + p′²), without a separate division.
      const double other = is_shared ? pdf(bsdf, outgoing_, way.direction, lobe) : 0;
      return throughput_ * f * way.radiance * (direct_weight_ * way.pdf / (way.pdf * way.pdf + other * other));
    };
    // Paths pass through panes and meet all lights that can be met; only the other lights are sampled through panes.
    const bool passes_panes = scene_.has_panes && !is_shared;
    Vec3 diffuse = diffuse_path_groups_ || (passes_panes && diffuse_state_) ? reflected(Lobe::diffuse) : Vec3{};
    Vec3 glossy = glossy_path_groups_ || (passes_panes && glossy_state_) ? reflected(Lobe::glossy) : Vec3{};
    if (is_black(diffuse) && is_black(glossy)) return;
    ++counts_.shadow_rays;
    uint32_t diffuse_path_groups = diffuse_path_groups_, glossy_path_groups = glossy_path_groups_;
    if (is_occluded(way, light ? scene_.accelerator.lift_of(group) : 0, is_shared ? Aim::random : Aim::exact)) {
      const auto panes = passes_panes ? panes_on(way) : std::nullopt;
      if (!panes) return;
      diffuse *= panes->share, glossy *= panes->share;
      diffuse_path_groups = path_groups_behind(panes->count, diffuse_state_);
      glossy_path_groups = path_groups_behind(panes->count, glossy_state_);
    }
    if (diffuse_path_groups) sink_.add(diffuse_path_groups, group, diffuse);
    if (glossy_path_groups) sink_.add(glossy_path_groups, group, glossy);
    if constexpr (Sink::follows_phase)
      sink_.end_way(light ? laser_path(*light, sink_.place_of_phase(point_.position)) : std::nullopt);
  }

  /// @param lift  distance by which the light's surface is moved toward rays [m]
  bool is_occluded(const LightSample& way, double lift, Aim aim) const {
    const Vec3 from = scene_.accelerator.leave(point_, way.direction);
    // The ray starts off the surface, up to a clearance nearer to the light.
    if (way.cosine == 0)
      return scene_.accelerator.is_occluded({from, way.direction}, way.distance - point_.clearance, aim);
    // The emitting surface itself is in the way: the ray ends before its plane, at grazing angles
    // sooner.
    const ScenePrecision& precision = scene_.accelerator.precision();
    const Vec3 end = point_.position + way.direction * way.distance, rest = end - from;
    const double distance = length(rest);
    // No corner of the emitting surface is farther from the centre than this.
    const double of_light = 2e-6 * (length(end - precision.centre) + way.size);
    return scene_.accelerator.is_occluded({from, rest * (1 / distance)},
                                          distance - (lift + of_light) / std::max(way.cosine, 0.01), aim);
  }

  /// The panes between the point and a light, if there is nothing else and the path may be that long.
  struct Panes {
    int count = 0;
    Vec3 share{1, 1, 1};  // fraction of the light that they transmit
  };

  std::optional<Panes> panes_on(const LightSample& way) {
    Ray ray{scene_.accelerator.leave(point_, way.direction), way.direction};
    double left = way.distance - 2 * point_.clearance;  // as in is_occluded
    for (Panes panes; depth_ + panes.count <= scene_.params.max_depth; ++panes.count) {
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
    for (; panes > 0; --panes) state = automaton_.step(state, PathEvent::specular);
    return automaton_.accepted(state);
  }

  /// Goes to the next surface; false if the path ends.
  bool leave(const BsdfSample& next) {
    state_ = automaton_.step(state_, event_of(next.lobe));
    if (automaton_.is_dead(state_)) {
      ++counts_.left_out;
      return false;
    }
    const bool is_last = depth_ >= scene_.params.max_depth;
    const Ray ray{scene_.accelerator.leave(point_, next.direction), next.direction};
    if (is_last && !emitters_.shine_beyond_surfaces()) {
      ++counts_.rays;
      const bool has_met = scene_.accelerator.is_occluded(ray, std::numeric_limits<double>::infinity());
      ++(has_met ? counts_.cut : counts_.escaped);
      return false;
    }
    if constexpr (Sink::follows_phase) sink_.scatter(point_, next);

    ++counts_.rays;
    pdf_ = next.lobe == Lobe::specular ? 0 : next.pdf;
    const Vec3 here = point_.position;
    const bool has_hit = scene_.accelerator.closest_hit(ray, hit_, pdf_ > 0 ? Aim::random : Aim::exact);
    distance_ = has_hit ? hit_.distance : std::numeric_limits<double>::infinity();
    // A lamp in the plane of a wall counts as in front of it, as in the sampling of lights.
    if (emitters_.shine_beyond_surfaces())
      add_light_on_way(ray, distance_ + (has_hit ? point_.clearance : 0), state_, pdf_, throughput_);
    outgoing_ = -next.direction;
    if (has_hit && point_.light >= 0) {
      add_lamp();
      return false;
    }
    if (!has_hit || is_last) {
      ++(has_hit ? counts_.cut : counts_.escaped);
      return false;
    }
    const Material& material = scene_.scene.materials[size_t(point_.material)];
    if constexpr (Sink::follows_phase) sink_.travel(length(point_.position - here));
    if (material.normal_map) point_ = shading_point(material, point_);
    return true;
  }

  const PathScene& scene_;
  const PathAutomaton& automaton_;
  const Emitters& emitters_;
  Sink& sink_;
  PathCounts& counts_;

  PathAutomaton::State state_ = 0;
  Hit hit_;
  SurfacePoint& point_ = hit_.point;
  Vec3 outgoing_, throughput_{1, 1, 1};
  int depth_ = 1;
  double direct_weight_ = 1;       // weight of sampled light
  double scale_ = 1;               // factor of the throughput from refractive indices
  double pdf_ = 0, distance_ = 0;  // of the direction that led here; 0: specular, or start of the path
  PathAutomaton::State diffuse_state_ = 0, glossy_state_ = 0;  // after these lobes of this surface; 0: no such lobe
  uint32_t diffuse_path_groups_ = 0, glossy_path_groups_ = 0;  // that accept light by these lobes
};

}  // namespace holotrace
