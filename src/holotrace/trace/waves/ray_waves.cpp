#include "holotrace/trace/waves/ray_waves.h"

#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "holotrace/base/cycles.h"
#include "holotrace/base/random.h"
#include "holotrace/data/sources.h"
#include "holotrace/trace/materials/bsdf.h"
#include "holotrace/trace/waves/source_phase.h"

namespace holotrace {

namespace {

/// Adds light that needs no path.
void add_known_light(const PathScene& scene, const SpecularLeaf& leaf, std::vector<Vec3>& sums) {
  const PathStart& start = leaf.start;
  const Emitters& emitters = scene.emitters;
  int group = leaf.light;
  Vec3 radiance;
  switch (leaf.kind) {
    case LeafKind::surface:
      return;
    case LeafKind::glow:
      group = emitters.mesh_group();
      radiance = emitted_radiance(scene.scene.materials[size_t(start.point.material)], start.point, scene.lines);
      break;
    case LeafKind::light:
      radiance = std::get<RectangleLight>(emitters.lights()[size_t(group)]).radiance;
      break;
    case LeafKind::beyond:
      group = emitters.background_group();
      radiance = emitters.background(-start.outgoing);
      break;
  }
  radiance *= start.seen ? start.seen->of_unpolarised() : Vec3{1, 1, 1} * scene.share_of_unpolarised();
  const int path_groups = scene.automaton.path_groups();
  for (int path_group = 0; path_group < path_groups; ++path_group)
    if (scene.automaton.accepted(start.state) >> path_group & 1)
      sums[size_t((scene.params.separate_lights ? group * path_groups : 0) + path_group)] += radiance;
}

LeafLight light_from(const PathScene& scene, const TraceParams& params, const SpecularLeaf& leaf, uint64_t sample,
                     PathCounts& counts) {
  LeafLight light;
  const size_t count = size_t(scene.sums());
  const bool is_known = leaf.kind != LeafKind::surface;
  if (params.phase == SourcePhase::laser) {
    light.phasors.resize(count);
    if (!is_known) {
      laser_phasors(scene, leaf.start, params.paths, sample, light.phasors, counts);
      return light;
    }
  }
  light.radiance.resize(count);
  if (!is_known) {
    mean_radiance(scene, leaf.start, params.paths, sample, light.radiance, counts);
    return light;
  }
  add_known_light(scene, leaf, light.radiance);
  const auto phase = std::polar(1.0, random_phase(scene.params.seed, 0, sample));
  for (size_t i = 0; i < light.phasors.size(); ++i) {
    const Vec3 radiance = light.radiance[i];
    light.phasors[i] = {std::sqrt(radiance.x) * phase, std::sqrt(radiance.y) * phase, std::sqrt(radiance.z) * phase};
  }
  return light;
}

/// Moves the phase of the wave to the place that represents the cell: its middle, projected onto the surface.
void move_phase(SpecularLeaf& leaf, const Ray& ray, Vec3 middle) {
  const SurfacePoint& point = leaf.start.point;
  const Vec3 way = middle - point.position;
  const Vec3 move = way - point.geometric_normal * dot(way, point.geometric_normal);
  leaf.start.phase_move = move;
  if (leaf.chain.empty())
    leaf.optical_path = leaf.distance =
        std::copysign(length(point.position + move - ray.origin), dot(point.position - ray.origin, ray.direction));
  else
    leaf.optical_path -= leaf.start.index * dot(move, leaf.start.outgoing);
}

/// The key of a leaf's random phase, and the cell of equal phase. With the strategy gather the leaf's phase
/// becomes that of the cell.
std::pair<uint64_t, WaveCell> place_in_cell(SpecularLeaf& leaf, const TraceParams& params, double side, const Ray& ray,
                                            uint64_t sample) {
  const bool is_constant = params.phase == SourcePhase::constant;
  if (params.phase == SourcePhase::random || leaf.kind == LeafKind::beyond) {
    // The particle and the surface behind it on the same ray have phases of their own.
    const uint64_t key = leaf.start.point.is_particle() ? mix(sample + splitmix_step) : sample;
    return {is_constant ? Sources::no_phase_key : key, {}};
  }
  const Vec3 place = leaf.start.point.position;
  const SurfaceCell cell = surface_cell(place, side);
  const WaveCell own{image_key(cell.key, leaf.chain), length(cell.centre - place), {}};
  if (params.strategy == Strategy::gather && params.one_wave_per_cell) move_phase(leaf, ray, cell.centre);
  return {is_constant ? Sources::no_phase_key : cell.key, own};
}

bool looks_alike_from_everywhere(const PathScene& scene, const PathStart& start) {
  const Bsdf bsdf = make_bsdf(material_at(scene.scene, start.point), start.point, scene.lines);
  const LobeSet lobes = lobes_of(bsdf);
  return lobes.has_diffuse && !lobes.has_glossy && specular_branches(bsdf, start.outgoing).count == 0;
}

/// The first surface on a ray as a leaf, dimmed by the media before it, and a particle of those media as another. If the ray meets no
/// surface, the background in place of one.
std::vector<SpecularLeaf> first_hits(const PathScene& scene, const Ray& ray, PathCounts& counts) {
  ++counts.rays;
  std::vector<SpecularLeaf> leaves;
  const auto add = [&](const Hit& hit, Vec3 weight) {
    const Material& material = material_at(scene.scene, hit.point);
    SpecularLeaf leaf;
    leaf.start = {shading_point(material, hit.point), -ray.direction, scene.automaton.start(), 1};
    leaf.optical_path = leaf.distance = hit.distance;
    leaf.weight = weight;
    leaves.push_back(std::move(leaf));
  };
  const auto hit = scene.accelerator.closest_hit(ray, Aim::exact, {.has_media = false});
  const double distance = hit ? hit->distance : std::numeric_limits<double>::infinity();
  if (hit) {
    add(*hit, scene.accelerator.transmittance(ray, distance));
  } else if (scene.params.shows_background) {
    SpecularLeaf leaf;
    leaf.kind = LeafKind::beyond;
    leaf.start.outgoing = -ray.direction;
    leaf.start.state = scene.automaton.start();
    leaf.is_far = true;
    leaf.distance = leaf.optical_path = background_distance;
    leaf.weight = scene.accelerator.transmittance(ray, distance);
    leaves.push_back(std::move(leaf));
  }
  if (const auto particle = scene.accelerator.particle_before(ray, distance)) add(*particle, particle->weight);
  return leaves;
}

}  // namespace

std::vector<RayWave> find_waves(const PathScene& scene, const TraceParams& params, double side, const Ray& ray,
                                uint64_t sample, PathCounts& counts) {
  const Ray seen = scene.accelerator.from_viewer(ray);
  std::vector<SpecularLeaf> leaves =
      follows_mirrors(params.phase) ? follow_specular(scene, seen, counts) : first_hits(scene, seen, counts);
  const double to_panel = length(ray.origin - seen.origin);
  std::vector<RayWave> waves;
  for (SpecularLeaf& leaf : leaves) {
    leaf.optical_path -= to_panel;
    leaf.distance -= to_panel;
    if (leaf.lines) leaf.lines->first -= to_panel, leaf.lines->second -= to_panel;
    const bool is_place = leaf.chain.empty() && leaf.kind != LeafKind::beyond;
    const Vec3 origin = is_place ? leaf.start.point.position : ray.origin + ray.direction * leaf.distance;
    auto [key, cell] = place_in_cell(leaf, params, side, ray, sample);
    cell.image = origin;
    LeafLight light = light_from(scene, params, leaf, sample, counts);
    const bool is_diffuse = leaf.kind == LeafKind::surface && looks_alike_from_everywhere(scene, leaf.start);
    waves.push_back({std::move(leaf), origin, {}, key, cell, std::move(light), is_diffuse});
  }
  return waves;
}

double phase_beyond(const RayWave& wave, double length, double wavelength, int line) {
  const Vec3 fresnel = wave.leaf.phase;
  return 2 * pi * cycle_fraction(wave.leaf.optical_path - length, wavelength) + (line == 0   ? fresnel.x
                                                                                 : line == 1 ? fresnel.y
                                                                                             : fresnel.z);
}

std::optional<SeenLight> light_toward(const PathScene& scene, const TraceParams& params, const RayWave& wave,
                                      Vec3 place, uint64_t sample, PathCounts& counts) {
  const SpecularLeaf& model = wave.leaf;
  SpecularLeaf leaf;
  if (model.chain.empty() && model.kind == LeafKind::beyond) {
    ++counts.shadow_rays;
    const Ray ray = scene.accelerator.from_viewer({place, -model.start.outgoing});
    if (scene.accelerator.is_occluded(ray, std::numeric_limits<double>::infinity(), Aim::exact, {Veils::Kind::passed}))
      return std::nullopt;
    return SeenLight{std::nullopt, model.weight};
  }
  if (model.chain.empty()) {
    const SurfacePoint& point = model.start.point;
    const Vec3 way = point.position.z < place.z ? place - point.position : point.position - place;
    if (dot(way, point.geometric_normal) <= 0) return std::nullopt;
    ++counts.shadow_rays;
    // At grazing angles the surface would hide its own point. Whether veils let the light pass was drawn when the wave was found.
    if (scene.accelerator.is_hidden(place, scene.accelerator.leave(point), {Veils::Kind::passed})) return std::nullopt;
    if (wave.is_diffuse) return SeenLight{std::nullopt, model.weight};
    leaf = model;
    leaf.start.outgoing = normalize(way);
  } else {
    const Vec3 way = wave.origin - place;
    const Vec3 back = wave.astigmatic ? -wave.astigmatic->at(place).direction : normalize(way.z < 0 ? way : -way);
    const Ray ray = scene.accelerator.from_viewer({place, back});
    auto found = follow_like(scene, ray, model, counts);
    if (!found || !shows_the_same(scene, *found, model, ray)) return std::nullopt;
    if (wave.is_diffuse && !scene.detector) return SeenLight{std::nullopt, found->weight};
    leaf = std::move(*found);
  }
  return SeenLight{light_from(scene, params, leaf, sample, counts), leaf.weight};
}

}  // namespace holotrace
