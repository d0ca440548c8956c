#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <variant>

#include "holotrace/trace/geometry/light_surfaces.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/paths/direct_light.h"
#include "holotrace/trace/paths/path.h"

// The one loop along a light path (formulas: path.h, add_radiance). The light found goes to a Sink:
//
//   static constexpr bool follows_phase        whether start, scatter and travel are called
//   static constexpr bool is_by_path           whether of_path is called
//   of_path(path)                              what is added next is light of this path of a block, 0 … 15
//   add(path_groups, group, radiance)               light of a group for the path groups whose bits are set
//   end_way(laser_path, reflection)            all light of one contribution was added; for a laser: its optical path
//                                              from there to the surface, else none; mirrors and glass on that way
//   start(start), scatter(point, sample), travel(distance)   the path begins, leaves a surface, reaches the next one
//   static constexpr bool follows_polarization  whether `seen` is there: the row of the path (StokesRow), which the walk changes;
//                                              light is then what the detector sees
//   place_of_phase(point)                      place on that surface at which the phase of light is evaluated

namespace holotrace {

template <class Sink>
class PathWalk {
 public:
  PathWalk(const PathScene& scene, Sink& sink, PathCounts& counts)
      : scene_(scene),
        automaton_(scene.automaton),
        emitters_(scene.emitters),
        sink_(sink),
        counts_(counts),
        direct_light_(scene, sink, counts) {}
  PathWalk(const PathWalk&) = delete;

  void follow(const PathStart& start, LowDiscrepancy& numbers) {
    if (begin(start)) go_on(numbers);
  }

  /// Begins a path at its first surface; false if it ends there, at a lamp.
  /// @param count  of paths that begin there: counts and light of the start are those of all
  bool begin(const PathStart& start, int count = 1) {
    set_start(start);
    if (point().light < 0)
      if constexpr (Sink::follows_phase) sink_.start(start);
    return begin_here(count);
  }

  /// Goes back to the start: the next path begins there, which `begin` has counted.
  void set_start(const PathStart& start) {
    hit_ = &own_;
    own_.point = start.point;
    set_first(start.state, start.outgoing, start.depth, start.aim);
    if constexpr (Sink::follows_polarization)
      if (start.seen) sink_.seen = *start.seen;
  }

  /// Goes to the first surface on a ray of a camera, to begin there; false if there is none.
  bool find(const Ray& ray) {
    ++counts_.rays;
    hit_ = &own_;
    if (!scene_.accelerator.closest_hit(ray, own_, Aim::random)) return false;
    set_found(ray);
    return true;
  }

  /// Goes to the surface that was found on a ray of a camera, to begin there. The hit must stay until the path has left it.
  void set_found(const Ray& ray, Hit& hit) {
    hit_ = &hit;
    set_found(ray);
  }

  /// The weight of light from beyond, if `find` has found nothing.
  const Vec3& weight_beyond() const { return hit_->weight; }

  /// Begins a path at the surface that was found; false if it ends there, at a lamp.
  bool begin_here(int count = 1) {
    counts_.paths += count;
    const Vec3 of_one = throughput_;
    throughput_ *= count;
    if (point().light >= 0)
      add_lamp(count);
    else
      arrive(count);
    throughput_ = of_one;
    return point().light < 0;
  }

  /// Follows the path from the surface that it has reached to its end.
  void go_on(LowDiscrepancy& numbers) {
    hero_ = scene_.hero_of(numbers);
    const Lines lines = scene_.lines_of(hero_);
    for (;;) {
      const Bsdf bsdf = common_ ? common_->bsdf : make_bsdf(material(), point(), lines);
      // One visit per surface: inside it the functions of this kind of surface are called directly.
      const auto next = std::visit([&](const auto& b) { return scatter(b, numbers); }, bsdf);
      if (!next) return;
      if constexpr (Sink::follows_phase) sink_.scatter(point(), *next);
      if (scene_.caustics.has_rectangles && next->lobe != Lobe::specular)
        last_scatter_ = {point(), next->direction, point().is_particle() ? 0 : next->pdf, depth_};
      if (!leave({scene_.accelerator.leave(point(), next->direction), next->direction}, next->lobe, next->pdf)) return;
    }
  }

  /// The surface that the path has reached, and the throughput on the way to it.
  const SurfacePoint& point() const { return hit_->point; }
  const Material& material() const { return scene_.scene.materials[size_t(point().material)]; }
  const Vec3& throughput() const { return throughput_; }
  PathAutomaton::State state() const { return state_; }
  int depth() const { return depth_; }
  Aim aim() const { return aim_; }

  /// Whether a path that has left surface `depth`, now in `state`, looks for the next one.
  bool looks_on(PathAutomaton::State state, int depth) const {
    return !automaton_.is_dead(state) && (depth < scene_.params.max_depth || emitters_.shine_beyond_surfaces());
  }

  /// A path that has left a diffuse surface.
  struct Leaving {
    PathAutomaton::State state;
    int depth;
    Vec3 throughput;
    bool is_counted;  ///< see is_counted_
    const DiffuseSurfaces& surfaces;
    size_t index;  ///< of its surface among them
  };

  /// Continues a path that left a surface along a ray drawn with density `pdf` [1/sr]. False if it ends before another surface.
  /// @param hit  the first surface on the ray, if the path looks on; nullptr if there is none. It must stay until the path has left it.
  bool leave_diffuse(const Leaving& path, const Ray& ray, double pdf, Hit* hit) {
    if (scene_.caustics.has_rectangles)
      last_scatter_ = {path.surfaces.point(path.index), ray.direction, pdf, path.depth};
    state_ = path.state;
    depth_ = path.depth;
    throughput_ = path.throughput;
    is_counted_ = path.is_counted;
    scale_ = 1;
    pdf_ = pdf;
    aim_ = Aim::random;
    if (!looks_on(state_, depth_)) return end(ray);
    ++counts_.rays;
    hit_ = hit ? hit : &own_;
    if (!hit) own_.weight = {1, 1, 1};  // the throughput has it
    return reach(ray, ray.origin, hit);
  }

  /// What paths from one start share.
  struct CommonStart {
    Bsdf bsdf;
    int dimensions = 0;  ///< of each path, for the lights that are sampled at the start
  };

  /// Adds what paths 0 … paths − 1 of the numbers find by sampling the lights at their common start. Walks that follow
  /// these paths leave that out (set_common).
  CommonStart add_direct_light_at_start(const PathStart& start, int paths, LowDiscrepancy& numbers) {
    set_start(start);
    CommonStart common{make_bsdf(material(), point(), scene_.lines)};
    common.dimensions = std::visit(
        [&](const auto& b) { return direct_light_.add_for_paths(b, vertex(), paths, numbers); }, common.bsdf);
    return common;
  }

  /// The next call of `follow` begins at this start, where the lights have been sampled already.
  void set_common(const CommonStart* common) { common_ = common; }

  /// Adds light on a ray before `distance` and not on a surface. The path came in `state` with density `pdf` [1/sr]; 0
  /// means by a specular branch.
  void add_light_on_way(const Ray& ray, double distance, PathAutomaton::State state, double pdf, Vec3 throughput) {
    const uint32_t path_groups = automaton_.accepted(state);
    if (!path_groups) return;
    for (const int i : emitters_.lights_on_way()) {
      const auto& light = std::get<RectangleLight>(emitters_.lights()[size_t(i)]);
      const auto met = meet(light, ray);
      if (!met || met->distance >= distance) continue;
      const double weight = pdf > 0 ? shared_weight(pdf, met->pdf) : weight_by_mirrors(i, ray, met->distance);
      add_met(path_groups, i, throughput * light.radiance * weight);
    }
    if (distance < std::numeric_limits<double>::infinity()) return;
    Vec3 radiance = emitters_.even_background();
    if (const EnvironmentLight* environment = emitters_.environment())
      radiance +=
          environment->radiance(ray.direction) * (pdf > 0 ? shared_weight(pdf, environment->pdf(ray.direction)) : 1);
    add_met(path_groups, emitters_.background_group(), throughput * radiance);
  }

 private:
  void set_found(const Ray& ray) {
    if (point().light < 0 && has_mapped_normals(material())) hit_->point = shading_point(material(), point());
    set_first(automaton_.start(), -ray.direction, 1, Aim::random);
    throughput_ = hit_->weight;
  }

  void set_first(PathAutomaton::State state, Vec3 outgoing, int depth, Aim aim) {
    state_ = state;
    outgoing_ = outgoing;
    depth_ = depth;
    aim_ = aim;
    throughput_ = {1, 1, 1};
    scale_ = 1;
    pdf_ = distance_ = 0;
    last_scatter_.pdf = 0;
    is_counted_ = true;
    if constexpr (Sink::follows_polarization) sink_.seen = row_of(*scene_.detector, outgoing);
  }

  /// Counts the surface that the path has reached, and adds what it emits.
  void arrive(int count = 1) {
    counts_.vertices += count;
    if (emitters_.is_emissive(point().material)) add_emission(material());
  }

  PathVertex vertex() const { return {point(), outgoing_, state_, depth_, aim_, throughput_, hero_}; }

  /// Whether light of different lines leaves a surface of dispersive glass in different directions, also where it reflects: a rough one.
  /// A smooth one reflects all lines in the same direction, each by its own reflectance.
  static bool bends_in_facets(const DielectricBsdf& b) { return !b.is_smooth(); }
  static bool bends_in_facets(const PrincipledBsdf& b) { return b.glass > 0 && bends_in_facets(b.solid); }
  template <class B>
  static bool bends_in_facets(const B&) {
    return false;
  }

  /// From here on the path carries the light of its hero alone. Roulette divides the factor out, as it does that of refraction.
  void part() {
    throughput_ *= hero_.parting;
    scale_ *= max_component(hero_.parting);
    hero_.parting = {1, 1, 1};
  }

  void add_met(uint32_t path_groups, int group, Vec3 light) {
    if (is_black(light)) return;
    if constexpr (Sink::follows_polarization) light *= sink_.seen.of_unpolarised();
    sink_.add(path_groups, group, light);
    sink_.end_way(std::nullopt, {});
  }

  /// Adds the emission of the surface itself.
  void add_emission(const Material& material) {
    const uint32_t path_groups = automaton_.accepted(state_);
    if (!path_groups) return;
    Vec3 light = throughput_ * emitted_radiance(material, point(), scene_.lines);
    if (pdf_ > 0 && !point().is_particle()) {  // particles are only met
      const double cosine = std::abs(dot(point().geometric_normal, outgoing_));
      light *= shared_weight(pdf_, emitters_.triangles().pdf(point().mesh, point().triangle, distance_, cosine));
    }
    add_met(path_groups, emitters_.mesh_group(), light);
  }

  /// Adds the light of a visible rectangle at whose surface the path ends. As for other lights, its surface does not
  /// count for max_depth.
  void add_lamp(int count = 1) {
    counts_.absorbed += count;
    const uint32_t path_groups = automaton_.accepted(state_);
    if (!path_groups || !point().is_front) return;
    const auto& light = std::get<RectangleLight>(emitters_.lights()[size_t(point().light)]);
    const double cosine = std::abs(dot(point().geometric_normal, outgoing_));
    const double weight = pdf_ > 0 ? shared_weight(pdf_, pdf(light, distance_, cosine))
                                   : weight_by_mirrors(point().light, {point().position, -outgoing_}, 0);
    add_met(path_groups, point().light, throughput_ * light.radiance * weight);
  }

  /// The weight of the light of a rectangle that the path has met by mirrors and glass, at a distance along a ray: DirectLight
  /// has sampled it as well, at the last surface from which the path went in a random direction.
  double weight_by_mirrors(int light, const Ray& ray, double distance) {
    if (!(last_scatter_.pdf > 0)) return 1;
    const LampPlace met{size_t(light), ray.origin + ray.direction * distance, hero_};
    const double pdf =
        caustic_pdf(scene_, last_scatter_.point, last_scatter_.direction, met, depth_ - last_scatter_.depth,
                    scene_.params.max_depth - last_scatter_.depth, counts_);
    return shared_weight(last_scatter_.pdf, pdf);
  }

  /// Samples the lights, and draws how the path continues; no result if it ends.
  template <class B>
  std::optional<BsdfSample> scatter(const B& bsdf, LowDiscrepancy& numbers) {
    const LobeSet has = lobes(bsdf);
    const bool parts = scene_.parts(material());
    if (parts && bends_in_facets(bsdf)) part();
    const bool asks_at_end = scene_.params.asks_at_end && depth_ < scene_.params.max_depth;
    if (common_)
      numbers.skip(std::exchange(common_, nullptr)->dimensions);
    else if (!asks_at_end)
      direct_light_.add(bsdf, vertex(), 1, numbers);
    const Vec2 choices = numbers.two(), u = numbers.two();  // for the lobe, and for roulette
    const Vec3 before = throughput_;
    auto next = sample(bsdf, outgoing_, choices.x, u);
    if (next) {
      throughput_ *= next->weight;
      scale_ *= next->squared_index_ratio;
    }
    // Radiance is n² times as large inside glass without being more light: roulette divides that out.
    const double share = next ? std::min(1.0, max_component(throughput_) / scale_) : 0;
    is_counted_ = choices.y < share;
    const bool may_end = depth_ >= scene_.params.roulette_depth || scene_.params.asks_at_end;
    double goes_on = may_end || share == 0 ? share : 1;
    constexpr double most = 0.9;  // keeps the weight of light at rare ends small
    if (asks_at_end && (has.has_diffuse || has.has_glossy)) goes_on = std::min(goes_on, most);
    if (!(choices.y < goes_on)) {
      ++counts_.absorbed;
      throughput_ = before;
      if (asks_at_end) direct_light_.add(bsdf, vertex(), 1 / (1 - goes_on), numbers);
      return std::nullopt;
    }
    throughput_ *= 1 / goes_on;
    if (parts && next->is_transmission && next->lobe == Lobe::specular) part();
    if constexpr (Sink::follows_polarization)
      sink_.seen.pass(polarization_of(bsdf, outgoing_, next->direction, next->lobe), outgoing_);
    return next;
  }

  /// Goes along a ray, drawn with density `pdf`, to the next surface; false if the path ends.
  bool leave(const Ray& ray, Lobe lobe, double pdf) {
    state_ = automaton_.step(state_, event_of(lobe));
    pdf_ = lobe == Lobe::specular ? 0 : pdf;
    if (pdf_ > 0) aim_ = Aim::random;
    if (!looks_on(state_, depth_)) return end(ray);
    ++counts_.rays;
    const Vec3 here = point().position;
    hit_ = &own_;
    return reach(ray, here, scene_.accelerator.closest_hit(ray, own_, aim_));
  }

  /// Ends a path that does not look on along a ray. For max_depth, it is counted whether a surface would have followed.
  bool end(const Ray& ray) {
    if (automaton_.is_dead(state_)) {
      ++counts_.left_out;
    } else if (!is_counted_) {
      ++counts_.absorbed;
    } else {
      ++counts_.rays;
      const bool has_met = scene_.accelerator.is_occluded(ray, std::numeric_limits<double>::infinity());
      ++(has_met ? counts_.cut : counts_.escaped);
    }
    return false;
  }

  /// Arrives at the surface that a ray from `here` has met, if it has; false if the path ends.
  bool reach(const Ray& ray, [[maybe_unused]] Vec3 here, bool has_hit) {
    distance_ = has_hit ? hit_->distance : std::numeric_limits<double>::infinity();
    if (scene_.accelerator.has_media()) throughput_ *= hit_->weight;
    // A lamp in the plane of a wall counts as in front of it, as in the sampling of lights.
    if (emitters_.shine_on_way())
      add_light_on_way(ray, distance_ + (has_hit ? point().clearance : 0), state_, pdf_, throughput_);
    outgoing_ = -ray.direction;
    if (has_hit && point().light >= 0) {
      add_lamp();
      return false;
    }
    if (!has_hit || depth_ >= scene_.params.max_depth) {
      ++(!has_hit ? counts_.escaped : is_counted_ ? counts_.cut : counts_.absorbed);
      return false;
    }
    if constexpr (Sink::follows_phase) sink_.travel(length(point().position - here));
    if (has_mapped_normals(material())) hit_->point = shading_point(material(), point());
    ++depth_;
    arrive();
    return true;
  }

  const PathScene& scene_;
  const PathAutomaton& automaton_;
  const Emitters& emitters_;
  Sink& sink_;
  PathCounts& counts_;

  PathAutomaton::State state_ = 0;
  Hit own_;
  Hit* hit_ = &own_;  // that the path has reached: its own, or one of those that were found for a group of paths
  Vec3 outgoing_, throughput_{1, 1, 1};
  int depth_ = 1;
  double scale_ = 1;  // factor of the throughput from refractive indices and from parted lines
  Hero hero_;
  double pdf_ = 0, distance_ = 0;  // of the direction that led here; 0: specular, or start of the path

  /// The last surface from which the path went in a random direction, if rectangles have caustics.
  struct Scatter {
    SurfacePoint point;
    Vec3 direction;
    double pdf = 0;  // [1/sr]; 0: none, or a particle, from which paths alone find such light
    int depth = 0;
  };
  Scatter last_scatter_;
  bool is_counted_ = true;  // whether the path counts as cut after the last surface, in proportion to its light
  Aim aim_ = Aim::exact;    // how the point was found
  DirectLight<Sink> direct_light_;
  const CommonStart* common_ = nullptr;
};

}  // namespace holotrace
