#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <optional>
#include <type_traits>

#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/paths/caustics.h"
#include "holotrace/trace/paths/diffuse_lanes.h"
#include "holotrace/trace/paths/path.h"

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
  Hero hero{};  ///< of the path
};

/// Paths of a block of random numbers (LowDiscrepancy) that have reached diffuse surfaces that only reflect.
struct DiffusePaths {
  std::array<uint32_t, most_together> number;  ///< in the block
  DiffuseSurfaces surfaces;
  LaneVectors throughput;  ///< with the reflectance of these surfaces

  void add(uint32_t path, const SurfacePoint& point, Vec3 start, Vec3 reflected) {
    const size_t i = size_t(surfaces.count++);
    number[i] = path;
    surfaces.position.set(i, point.position);
    surfaces.start.set(i, start);
    surfaces.normal.set(i, point.normal);
    surfaces.geometric_normal.set(i, point.geometric_normal);
    surfaces.clearance[i] = point.clearance;
    throughput.set(i, reflected);
  }

  /// Paths 0 … paths − 1, all of them at one place.
  void fill(int paths, const SurfacePoint& point, Vec3 start, Vec3 reflected) {
    surfaces.count = paths;
    std::iota(number.begin(), number.end(), 0U);
    surfaces.position.fill(point.position);
    surfaces.start.fill(start);
    surfaces.normal.fill(point.normal);
    surfaces.geometric_normal.fill(point.geometric_normal);
    surfaces.clearance.fill(point.clearance);
    throughput.fill(reflected);
  }
};

/// Adds the light that arrives at a surface straight from the lights, and what it reflects of that light, to a sink
/// (path_walk.h).
template <class Sink>
class DirectLight {
 public:
  DirectLight(const PathScene& scene, Sink& sink, PathCounts& counts) : scene_(scene), sink_(sink), counts_(counts) {}

  /// Each light is sampled once. The light is multiplied by `weight`. Without a clamp, every fourth path looks for the caustics
  /// of rectangles, and counts for four.
  template <class B>
  void add(const B& bsdf, const PathVertex& at, double weight, LowDiscrepancy& numbers) {
    if (!begin(lobes(bsdf), at.state)) return;
    for_each_light(at.depth, [&](const SampledLight& light, const auto& sample) {
      if (!light.is_shared) {
        add_unmet(bsdf, at, light, sample(at.point.position, {}), weight);
        return add_caustics(bsdf, at, light, {}, weight);
      }
      const Vec2 u = numbers.two();
      const LightSample way = sample(at.point.position, u);
      if (const auto reflected = reflect(bsdf, at, way, true, weight)) add_if_visible(at, way, light, *reflected);
      // A number below 1/4 also says where on the light. A clamp would take what one path finds for four.
      if (scene_.params.clamp > 0)
        add_caustics(bsdf, at, light, u, weight);
      else if (u.x < 0.25)
        add_caustics(bsdf, at, light, {4 * u.x, u.y}, 4 * weight);
    });
  }

  /// The sum of `add` with weight 1 over paths 0 … paths − 1 of the numbers, which reach the same surface and begin
  /// there. Shadow rays are traced together; one is enough for a light that always lies in the same direction. An eighth of the
  /// paths looks for the caustics of rectangles, and counts for all. Glass must not part the lines (PathScene::parts_lines).
  /// @return  number of dimensions that `add` takes of each path
  template <class B>
  int add_for_paths(const B& bsdf, const PathVertex& at, int paths, LowDiscrepancy& numbers) {
    static_assert(!Sink::follows_phase, "a phase needs the light of each path by itself");
    if (!begin(lobes(bsdf), at.state)) return 0;
    Waiting waiting;
    int taken = 0;
    for_each_light(at.depth, [&](const SampledLight& light, const auto& sample) {
      if (!light.is_shared) {
        add_unmet(bsdf, at, light, sample(at.point.position, {}), paths);
        return add_caustics(bsdf, at, light, {}, paths);
      }
      const int dimension = taken++;
      if (has_caustics(at, light)) {
        const int chosen = (paths + 7) / 8;
        for (int path = 0; path < chosen; ++path) {
          numbers.start(uint32_t(path));
          numbers.skip(dimension);
          add_caustics(bsdf, at, light, numbers.two(), double(paths) / chosen);
        }
      }
      if (const auto* surface = reflector(bsdf); surface && fits_lanes(light))
        return add_lanes_at(*surface, at, light, {paths, dimension}, numbers);
      for (int path = 0; path < paths; ++path) {
        numbers.start(uint32_t(path));
        numbers.skip(dimension);
        const LightSample way = sample(at.point.position, numbers.two());
        const auto reflected = reflect(bsdf, at, way, true, 1);
        if (!reflected) continue;
        waiting.add(shadow_ray(at, way, light), *reflected);
        if (waiting.count == most_together) add_visible(waiting, light.group);
      }
      add_visible(waiting, light.group);
    });
    return taken;
  }

  /// The sum of `add` with weight 1 over paths on surfaces of their own. Caustics are found for every fourth of the paths and
  /// count for all of them; for every eighth where the surfaces are first hits of a pixel.
  /// @param state, depth, aim  of all of them, as of PathVertex
  /// @param dimension          of the numbers, the first that the lights take; the numbers are at a path of the block
  /// @return                   number of dimensions taken of each path
  int add_for_group(const DiffusePaths& paths, PathAutomaton::State state, int depth, Aim aim, int dimension,
                    LowDiscrepancy& numbers) {
    if (!begin({.has_diffuse = true}, state)) return 0;
    const DiffuseSurfaces& surfaces = paths.surfaces;
    const bool are_near = depth == 1;  // first hits of a pixel
    int taken = 0;
    // Places in the row of paths, from a random one on: every path is chosen with the same probability.
    const auto count = size_t(paths.surfaces.count), every = size_t(are_near ? 8 : 4);
    const double apart = double(count) / double((count + every - 1) / every);
    double first = 0;
    if (!scene_.caustics.is_empty()) first = apart * 0x1p-32 * numbers.of_block(dimension + taken++).x[paths.number[0]];
    for_each_light(depth, [&](const SampledLight& light, const auto& sample) {
      LowDiscrepancy::Block places;
      if (light.is_shared) places = numbers.of_block(dimension + taken++);
      const auto place_of = [&](size_t i) {
        const uint32_t path = paths.number[i];
        return light.is_shared ? Vec2{places.x[path] * 0x1p-32, places.y[path] * 0x1p-32} : Vec2{};
      };
      const bool is_in_lanes = fits_lanes(light), has_caustics = light.light && !scene_.caustics.is_empty();
      if (is_in_lanes) add_lanes(paths, light, place_of, are_near);
      if (is_in_lanes && !has_caustics) return;
      double chosen = first;
      for (size_t i = 0; i < count; ++i) {
        const bool is_chosen = has_caustics && i == size_t(chosen);
        if (is_in_lanes && !is_chosen) continue;
        const SurfacePoint point = surfaces.point(i);
        const DiffuseBsdf bsdf{point.normal, point.geometric_normal, paths.throughput[i], {}};
        const PathVertex at{point, {}, state, depth, aim, {1, 1, 1}, scene_.hero(0)};  // none has been parted
        const Vec2 u = place_of(i);
        if constexpr (Sink::is_by_path) sink_.of_path(paths.number[i]);
        if (!light.is_shared) {
          add_unmet(bsdf, at, light, sample(point.position, u), 1);
        } else if (!is_in_lanes) {
          const LightSample way = sample(point.position, u);
          if (const auto reflected = reflect(bsdf, at, way, true, 1)) add_if_visible(at, way, light, *reflected);
        }
        if (!is_chosen) continue;
        add_caustics(bsdf, at, light, u, apart);
        chosen += apart;
      }
    });
    return taken;
  }

 private:
  static constexpr Veils only_surfaces{.has_media = false};  // on the way to a light; media dim it
  struct SampledLight {
    int group;
    bool is_shared;                ///< the path can also meet the light
    const Light* light = nullptr;  ///< none: meshes, or the environment
  };
  struct NoRows {};
  /// What the detector sees of light that arrives at the surface.
  struct Rows {
    StokesRow diffuse, glossy;
  };
  struct Reflected {
    Vec3 diffuse, glossy;
    [[no_unique_address]] std::conditional_t<Sink::follows_polarization, Rows, NoRows> rows{};

    /// The light has passed or met a surface before, from `incoming` toward `outgoing`.
    void pass(const Bsdf& bsdf, Vec3 outgoing, Vec3 incoming) {
      if constexpr (Sink::follows_polarization) {
        const PolarizationChange change = polarization_of(bsdf, outgoing, incoming, Lobe::specular);
        rows.diffuse.pass(change, outgoing);
        rows.glossy.pass(change, outgoing);
      }
    }
    Vec3 seen_diffuse() const {
      if constexpr (Sink::follows_polarization) return diffuse * rows.diffuse.of_unpolarised();
      return diffuse;
    }
    Vec3 seen_glossy() const {
      if constexpr (Sink::follows_polarization) return glossy * rows.glossy.of_unpolarised();
      return glossy;
    }
  };

  /// False if no path group accepts light of this surface.
  bool begin(LobeSet has, PathAutomaton::State state) {
    const PathAutomaton& automaton = scene_.automaton;
    diffuse_state_ = has.has_diffuse ? automaton.step(state, PathEvent::diffuse) : PathAutomaton::State{};
    glossy_state_ = has.has_glossy ? automaton.step(state, PathEvent::glossy) : PathAutomaton::State{};
    diffuse_path_groups_ = automaton.accepted(diffuse_state_);
    glossy_path_groups_ = automaton.accepted(glossy_state_);
    // Path groups that accept no light here may accept it behind a pane or by a mirror.
    return (diffuse_path_groups_ | glossy_path_groups_) || (passes_mirrors() && (diffuse_state_ | glossy_state_));
  }

  /// Calls visit(light, sample), sample(from, u) being a LightSample; u is used only for a light that is shared.
  template <class Visit>
  void for_each_light(int depth, const Visit& visit) const {
    const Emitters& emitters = scene_.emitters;
    const auto& lights = emitters.lights();
    for (size_t i = 0; i < lights.size(); ++i)
      visit({int(i), has_area(lights[i]), &lights[i]},
            [&](Vec3 from, Vec2 u) { return sample_light(lights[i], from, u); });
    // Light of a mesh comes from a surface, which counts for max_depth.
    if (depth < scene_.params.max_depth && !emitters.triangles().is_empty())
      visit({emitters.mesh_group(), true}, [&](Vec3 from, Vec2 u) { return emitters.triangles().sample(from, u); });
    if (const EnvironmentLight* environment = emitters.environment())
      visit({emitters.background_group(), true}, [&](Vec3, Vec2 u) { return environment->sample(u); });
  }

  /// Whether lights may also be sampled by panes, mirrors or glass.
  bool passes_mirrors() const { return scene_.has_panes || !scene_.mirrors.empty() || !scene_.caustics.is_empty(); }

  /// Adds the light of a light that no ray can meet: straight, through panes, and by each flat mirror.
  template <class B>
  void add_unmet(const B& bsdf, const PathVertex& at, const SampledLight& light, const LightSample& way,
                 double weight) {
    if (const auto reflected = reflect(bsdf, at, way, false, weight)) add_if_visible(at, way, light, *reflected);
    if (!light.light || at.depth >= scene_.params.max_depth) return;
    const auto& planes = scene_.mirrors;
    for (size_t m = 0; m < planes.size(); ++m) {
      const LightSample by_mirror = sample_light(planes[m].images[size_t(light.group)], at.point.position, {});
      if (const auto reflected = reflect(bsdf, at, by_mirror, false, weight))
        add_by_mirror(at, by_mirror, {m, light.group}, *reflected);
    }
  }

  /// Whether a light may come by mirrors and glass that caustic_light finds.
  bool has_caustics(const PathVertex& at, const SampledLight& light) const {
    // Paths from particles meet lights with an area by themselves.
    return !scene_.caustics.is_empty() && light.light && at.depth < scene_.params.max_depth &&
           !(light.is_shared && at.point.is_particle());
  }

  /// Adds the light that comes by curved mirrors, glass and several flat mirrors; from the place u of a light with an area. Where glass
  /// parts the lines, a path that has not been parted looks for the ways of all heroes.
  template <class B>
  void add_caustics(const B& bsdf, const PathVertex& at, const SampledLight& light, Vec2 u, double weight) {
    if (!has_caustics(at, light)) return;
    if (at.hero.parting == Vec3{1, 1, 1}) return add_caustics_of_hero(bsdf, at, light, u, weight);
    PathVertex of_hero = at;
    for (int number = 0; number < scene_.heroes(); ++number) {
      of_hero.hero = scene_.hero(number);
      add_caustics_of_hero(bsdf, of_hero, light, u, weight / scene_.heroes());
    }
  }

  template <class B>
  void add_caustics_of_hero(const B& bsdf, const PathVertex& at, const SampledLight& light, Vec2 u, double weight) {
    const auto* rectangle = std::get_if<RectangleLight>(light.light);
    const LampPlace lit_by{size_t(light.group), rectangle ? place_on(*rectangle, u) : Vec3{}, at.hero};
    const auto ways =
        caustic_light(scene_, at.point, lit_by, scene_.params.max_depth - at.depth, Sink::follows_phase, counts_);
    for (size_t i = 0; i < ways.size(); ++i) {
      const CausticLight& way = ways[i];
      const Vec3 radiance = way.is_parted ? way.radiance * at.hero.parting : way.radiance;
      auto reflected = reflect(bsdf, at, {.direction = way.direction, .radiance = radiance, .pdf = way.pdf},
                               Arrival{light.is_shared, true}, weight);
      if (!reflected) continue;
      if constexpr (Sink::follows_polarization)
        for (const CausticLight::Turn& turn : way.turns)
          reflected->pass(make_bsdf(material_at(scene_.scene, turn.point), turn.point, scene_.lines_of(at.hero)),
                          turn.outgoing, turn.incoming);
      add_behind(way.surfaces, light.group, *reflected);
      if constexpr (Sink::follows_phase) {
        std::optional<double> path;
        if (laser_path(*light.light, at.point.position)) {
          const Vec3 move = sink_.place_of_phase(at.point.position) - at.point.position;
          path = way.optical_path / way.index - dot(move, way.direction);
        }
        sink_.end_way(path, {int(scene_.mirrors.size() + i) + 1, way.phase});
      }
    }
  }

  /// Adds light that has met so many mirrors, panes and glass surfaces on its way.
  void add_behind(int surfaces, int group, const Reflected& light) {
    if (const auto groups = path_groups_behind(surfaces, diffuse_state_))
      sink_.add(groups, group, light.seen_diffuse());
    if (const auto groups = path_groups_behind(surfaces, glossy_state_)) sink_.add(groups, group, light.seen_glossy());
  }

  struct MirroredLight {
    size_t mirror;
    int group;
  };

  /// Adds the light of a mirror image, if the way to it meets that mirror first and is free from there to the light. The way to
  /// the image of a light on the other side of the mirror does not meet it.
  void add_by_mirror(const PathVertex& at, const LightSample& way, const MirroredLight& mirrored,
                     const Reflected& reflected) {
    const FlatMirror& mirror = scene_.mirrors[mirrored.mirror];
    const Ray ray{scene_.accelerator.leave(at.point, way.direction), way.direction};
    ++counts_.rays;
    const auto hit = scene_.accelerator.closest_hit(ray, at.aim, only_surfaces);
    if (!hit || hit->distance >= way.distance || !mirror.holds(hit->point)) return;
    const Material& material = material_at(scene_.scene, hit->point);
    const Bsdf bsdf = make_bsdf(material, shading_point(material, hit->point), scene_.lines);
    const SpecularBranches branches = specular_branches(bsdf, -way.direction);
    const auto last = branches.ways.begin() + branches.count;
    const auto back =
        std::find_if(branches.ways.begin(), last, [](const BsdfSample& branch) { return !branch.is_transmission; });
    if (back == last) return;
    ++counts_.shadow_rays;
    const Ray onward{scene_.accelerator.leave(hit->point, back->direction), back->direction};
    const double left = way.distance - length(hit->point.position - at.point.position);
    if (scene_.accelerator.is_occluded(onward, left - hit->point.clearance, at.aim)) return;
    const Vec3 passed = back->weight * scene_.accelerator.transmittance(ray, hit->distance) *
                        scene_.accelerator.transmittance(onward, left);
    Reflected light = reflected;
    light.diffuse *= passed, light.glossy *= passed;
    light.pass(bsdf, -way.direction, back->direction);
    add_behind(1, mirrored.group, light);
    if constexpr (Sink::follows_phase)
      sink_.end_way(laser_path(mirror.images[size_t(mirrored.group)], sink_.place_of_phase(at.point.position)),
                    {int(mirrored.mirror) + 1, back->phase});
  }

  /// Paths pass through panes and meet all lights that can be met; only the other lights are sampled through panes.
  bool passes_panes(const SampledLight& light) const { return scene_.has_panes && !light.is_shared; }

  /// The light that the surface reflects to path groups, if nothing hides its source.
  template <class B>
  std::optional<Reflected> reflect(const B& bsdf, const PathVertex& at, const LightSample& way, bool is_shared,
                                   double weight) const {
    return reflect(bsdf, at, way, {is_shared, passes_mirrors() && !is_shared}, weight);
  }

  struct Arrival {
    bool is_shared;       ///< with paths that meet the light
    bool passes_mirrors;  ///< it may come by mirrors or glass: path groups that do not accept light here may accept it
  };
  template <class B>
  std::optional<Reflected> reflect(const B& bsdf, const PathVertex& at, const LightSample& way, Arrival arrival,
                                   double weight) const {
    if (is_black(way.radiance) || !(way.pdf < most_light_density)) return std::nullopt;
    const auto of_lobe = [&](Lobe lobe) {
      const Vec3 f = eval(bsdf, at.outgoing, way.direction, lobe);
      if (is_black(f)) return Vec3{};
      // The weight over the density, p/(p² + p′²), without a separate division.
      const double other = arrival.is_shared ? pdf(bsdf, at.outgoing, way.direction, lobe) : 0;
      return at.throughput * f * way.radiance * (weight * way.pdf / (way.pdf * way.pdf + other * other));
    };
    const bool is_behind = arrival.passes_mirrors;
    Reflected light{diffuse_path_groups_ || (is_behind && diffuse_state_) ? of_lobe(Lobe::diffuse) : Vec3{},
                    glossy_path_groups_ || (is_behind && glossy_state_) ? of_lobe(Lobe::glossy) : Vec3{}};
    if (is_black(light.diffuse) && is_black(light.glossy)) return std::nullopt;
    if constexpr (Sink::follows_polarization) {
      light.rows = {sink_.seen, sink_.seen};
      light.rows.diffuse.pass({}, at.outgoing);
      light.rows.glossy.pass(polarization_of(bsdf, at.outgoing, way.direction, Lobe::glossy), at.outgoing);
    }
    return light;
  }

  void add_if_visible(const PathVertex& at, const LightSample& way, const SampledLight& light, Reflected reflected) {
    ++counts_.shadow_rays;
    uint32_t diffuse_path_groups = diffuse_path_groups_, glossy_path_groups = glossy_path_groups_;
    const ShadowRay ray = shadow_ray(at, way, light);
    if (scene_.accelerator.is_occluded(ray.ray, ray.distance, aim_at(at, light))) {
      const auto panes = passes_panes(light) ? panes_on(at, way, reflected) : std::nullopt;
      if (!panes) return;
      reflected.diffuse *= panes->share, reflected.glossy *= panes->share;
      diffuse_path_groups = path_groups_behind(panes->count, diffuse_state_);
      glossy_path_groups = path_groups_behind(panes->count, glossy_state_);
    }
    if (scene_.accelerator.has_media()) {
      const Vec3 passed = scene_.accelerator.transmittance(ray.ray, ray.distance);
      reflected.diffuse *= passed, reflected.glossy *= passed;
    }
    if (diffuse_path_groups) sink_.add(diffuse_path_groups, light.group, reflected.seen_diffuse());
    if (glossy_path_groups) sink_.add(glossy_path_groups, light.group, reflected.seen_glossy());
    if constexpr (Sink::follows_phase)
      sink_.end_way(light.light ? laser_path(*light.light, sink_.place_of_phase(at.point.position)) : std::nullopt, {});
  }

  static Aim aim_at(const PathVertex& at, const SampledLight& light) { return light.is_shared ? Aim::random : at.aim; }

  /// The surface, if it is diffuse and only reflects; else none.
  static const DiffuseBsdf* reflector(const DiffuseBsdf& b) { return b.transmission_probability == 0 ? &b : nullptr; }
  template <class B>
  static const DiffuseBsdf* reflector(const B&) {
    return nullptr;
  }

  /// Whether samples of the light on diffuse surfaces are made in vector lanes.
  bool fits_lanes(const SampledLight& light) const {
    const Emitters& emitters = scene_.emitters;
    if (!light.light) return light.group == emitters.mesh_group() && emitters.triangles().are_even();
    return light.is_shared || (std::holds_alternative<PointLight>(*light.light) && !passes_mirrors());
  }

  struct PathsAtDimension {
    int paths, dimension;
  };

  /// The light of such a light on such a surface, for all paths: 16 of them together.
  void add_lanes_at(const DiffuseBsdf& bsdf, const PathVertex& at, const SampledLight& light,
                    const PathsAtDimension& numbered, const LowDiscrepancy& numbers) {
    DiffusePaths together;
    const Vec3 start = scene_.accelerator.leave(at.point, at.point.geometric_normal);
    together.fill(most_together, at.point, start, at.throughput * bsdf.reflectance);
    for (int first = 0; first < numbered.paths; first += most_together) {
      const LowDiscrepancy::Block places = numbers.two_of_block(uint32_t(first / most_together), numbered.dimension);
      together.surfaces.count = std::min(most_together, numbered.paths - first);
      const auto place_of = [&](size_t i) { return Vec2{places.x[i] * 0x1p-32, places.y[i] * 0x1p-32}; };
      add_lanes(together, light, place_of, true);
    }
  }

  /// Adds what the surfaces reflect of such a light. Path i samples it by the numbers place_of(i).
  template <class PlaceOf>
  void add_lanes(const DiffusePaths& paths, const SampledLight& light, const PlaceOf& place_of, bool are_near) {
    if (!diffuse_path_groups_) return;
    const auto count = size_t(paths.surfaces.count);
    PlaceLanes places;
    if (light.light) {
      for (size_t i = 0; i < count; ++i) places.set(i, place_of(i));
      return add_lanes(paths, light, scene_.light_lanes[size_t(light.group)], places, are_near);
    }
    LightLanes triangles;
    triangles.are_triangles = true;
    for (size_t i = 0; i < count; ++i) scene_.emitters.triangles().select(place_of(i), i, triangles, places);
    add_lanes(paths, light, triangles, places, are_near);
  }

  void add_lanes(const DiffusePaths& paths, const SampledLight& light, const LightLanes& lanes,
                 const PlaceLanes& places, bool are_near) {
    const DiffuseSurfaces& at = paths.surfaces;
    LightSamples samples;
    sample_lights(at, lanes, places, scene_.accelerator.precision().centre, samples);
    LaneVectors reflected;
    uint32_t lit = 0;
    for (size_t i = 0; i < size_t(at.count); ++i) {
      const Vec3 light_of_path = paths.throughput[i] * lanes.radiance[i] * samples.share[i];
      reflected.set(i, light_of_path);
      lit |= uint32_t(!is_black(light_of_path)) << i;
    }
    if (!lit) return;
    counts_.shadow_rays += std::popcount(lit);
    const RayLanes rays{at.start, samples.direction, samples.distance};
    Vec3 sum;
    const bool has_media = scene_.accelerator.has_media();
    for (uint32_t seen = lit & ~scene_.accelerator.occluded(rays, lit, Aim::random, are_near); seen; seen &= seen - 1) {
      const auto i = size_t(std::countr_zero(seen));
      Vec3 arriving = reflected[i];
      if (has_media) arriving *= passed_by(rays, i);
      if constexpr (Sink::is_by_path) {
        sink_.of_path(paths.number[i]);
        sink_.add(diffuse_path_groups_, light.group, arriving);
      } else {
        sum += arriving;
      }
    }
    if constexpr (!Sink::is_by_path) sink_.add(diffuse_path_groups_, light.group, sum);
  }

  struct ShadowRay {
    Ray ray;
    double distance = 0;  // [m], may be infinite
  };

  /// Light that can be met, until its shadow rays are traced together.
  struct Waiting {
    LaneVectors origin, direction, diffuse, glossy;
    Lane distance;
    size_t count = 0;

    void add(const ShadowRay& shadow, const Reflected& reflected) {
      origin.set(count, shadow.ray.origin);
      direction.set(count, shadow.ray.direction);
      distance[count] = shadow.distance;
      diffuse.set(count, reflected.diffuse);
      glossy.set(count++, reflected.glossy);
    }
  };

  /// The share of the light on shadow ray i that media let pass.
  Vec3 passed_by(const RayLanes& rays, size_t i) const {
    return scene_.accelerator.transmittance({rays.origin[i], rays.direction[i]}, rays.distance[i]);
  }

  /// Adds the light that nothing hides; then none waits.
  void add_visible(Waiting& waiting, int group) {
    if (waiting.count == 0) return;
    counts_.shadow_rays += int64_t(waiting.count);
    const uint32_t asked = (1U << waiting.count) - 1;
    const RayLanes rays{waiting.origin, waiting.direction, waiting.distance};
    const bool has_media = scene_.accelerator.has_media();
    Reflected sum;
    for (uint32_t seen = asked & ~scene_.accelerator.occluded(rays, asked, Aim::random, true); seen; seen &= seen - 1) {
      const auto i = size_t(std::countr_zero(seen));
      const Vec3 passed = has_media ? passed_by(rays, i) : Vec3{1, 1, 1};
      sum.diffuse += waiting.diffuse[i] * passed;
      sum.glossy += waiting.glossy[i] * passed;
    }
    if (diffuse_path_groups_) sink_.add(diffuse_path_groups_, group, sum.diffuse);
    if (glossy_path_groups_) sink_.add(glossy_path_groups_, group, sum.glossy);
    waiting.count = 0;
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

  std::optional<Panes> panes_on(const PathVertex& at, const LightSample& way, Reflected& light) {
    Ray ray{scene_.accelerator.leave(at.point, way.direction), way.direction};
    double left = way.distance - 2 * at.point.clearance;  // as in shadow_ray
    for (Panes panes; at.depth + panes.count <= scene_.params.max_depth; ++panes.count) {
      ++counts_.rays;
      const auto hit = scene_.accelerator.closest_hit(ray, Aim::exact, only_surfaces);
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
      light.pass(pane, -way.direction, way.direction);
      const Vec3 next = scene_.accelerator.leave(hit->point, way.direction);
      left -= dot(next - ray.origin, way.direction);
      ray.origin = next;
    }
    return std::nullopt;
  }

  /// The path groups that accept light which met mirrors, panes or glass on its way to the surface; the path left it in `state`.
  uint32_t path_groups_behind(int surfaces, PathAutomaton::State state) const {
    for (; surfaces > 0; --surfaces) state = scene_.automaton.step(state, PathEvent::specular);
    return scene_.automaton.accepted(state);
  }

  const PathScene& scene_;
  Sink& sink_;
  PathCounts& counts_;
  PathAutomaton::State diffuse_state_ = 0, glossy_state_ = 0;  // after these lobes of the surface; 0: no such lobe
  uint32_t diffuse_path_groups_ = 0, glossy_path_groups_ = 0;  // that accept light by these lobes
};

}  // namespace holotrace
