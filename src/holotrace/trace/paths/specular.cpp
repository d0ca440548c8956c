#include "holotrace/trace/paths/specular.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <variant>

#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/bsdf.h"

namespace holotrace {

namespace {

constexpr double least_weight = 1e-3;

/// Traces a ray through the planes of a leaf's chain to the plane of its last surface.
std::optional<RayEnd> retrace(const SpecularLeaf& leaf, const Ray& ray, std::span<RayChange> changes = {}) {
  if (leaf.kind == LeafKind::beyond) return retrace(leaf.chain, ray, changes);
  const SurfacePoint& last = leaf.start.point;
  return retrace(leaf.chain, ray, last.position, last.geometric_normal, changes);
}

/// Curvature C of the wavefront at the ray's origin [1/m], positive if it diverges, in the axes x and y across the ray.
struct Curvature {
  double xx, xy, yy;
  Vec3 x, y;
  double twice_mean() const { return xx + yy; }
};

/// None if neighbouring rays show the same.
std::optional<Curvature> curvature_of(const SpecularLeaf& leaf, const Ray& ray, const RayEnd& end) {
  const Frame across = frame_from_normal(ray.direction);
  const Frame screen =
      frame_from_normal(leaf.kind == LeafKind::beyond ? end.direction : leaf.start.point.geometric_normal);
  std::array<RayChange, 4> changes{RayChange{across.x, {}}, {across.y, {}}, {{}, across.x}, {{}, across.y}};
  if (!retrace(leaf, ray, changes)) return std::nullopt;
  std::array<Vec2, 4> by;
  std::transform(changes.begin(), changes.end(), by.begin(), [&](const RayChange& change) {
    const Vec3 seen = leaf.kind == LeafKind::beyond ? change.direction : change.place;
    return Vec2{dot(seen, screen.x), dot(seen, screen.y)};
  });
  const auto& [q1, q2, d1, d2] = by;
  const double determinant = d1.x * d2.y - d2.x * d1.y;
  if (determinant == 0) return std::nullopt;
  const auto solved = [&](Vec2 q) {
    return Vec2{(d2.y * q.x - d2.x * q.y) / determinant, (d1.x * q.y - d1.y * q.x) / determinant};
  };
  const Vec2 c1 = solved(q1), c2 = solved(q2);
  return Curvature{c1.x, (c1.y + c2.x) / 2, c2.y, across.x, across.y};  // symmetric but for rounding
}

FocalLines lines_of(const Curvature& c) {
  const double mean = c.twice_mean() / 2, difference = std::hypot((c.xx - c.yy) / 2, c.xy);
  // The direction of the greater curvature; the focal line of the other one lies along it.
  const double angle = std::atan2(2 * c.xy, c.xx - c.yy) / 2;
  const Vec3 greater = c.x * std::cos(angle) + c.y * std::sin(angle),
             less = c.y * std::cos(angle) - c.x * std::sin(angle);
  const auto distance = [](double curvature) {
    return std::abs(curvature) > 1 / farthest_line ? 1 / curvature : farthest_line;
  };
  const double of_greater = distance(mean + difference), of_less = distance(mean - difference);
  if (std::abs(of_less) >= std::abs(of_greater)) return {of_less, of_greater, greater};
  return {of_greater, of_less, less};
}

/// Moves the leaf to the end of the chain traced in double, and computes its apparent distance.
void place_leaf(const Ray& ray, SpecularLeaf& leaf) {
  if (leaf.chain.empty() && leaf.kind == LeafKind::beyond) {
    leaf.is_far = true;
    leaf.distance = leaf.optical_path = background_distance;
    return;
  }
  const auto end = retrace(leaf, ray);
  if (end) {
    if (leaf.kind != LeafKind::beyond) leaf.start.point.position = end->place;
    leaf.start.outgoing = -end->direction;
    leaf.optical_path = end->optical_path;
  }
  if (leaf.chain.empty()) {
    leaf.distance = leaf.optical_path;
    return;
  }
  const auto curvature = end ? curvature_of(leaf, ray, *end) : std::nullopt;
  leaf.is_far = !(curvature && std::abs(curvature->twice_mean()) > 2 / farthest_origin);
  leaf.distance = leaf.is_far ? farthest_origin : 2 / curvature->twice_mean();
  if (curvature) leaf.lines = lines_of(*curvature);
  if (leaf.kind == LeafKind::beyond) leaf.optical_path = leaf.distance;
}

/// Follows one tree, or the one branch of it that `guide` names.
struct Walk {
  const PathScene& scene;
  const Ray& first;
  const SpecularLeaf* guide;
  PathCounts& counts;
  std::vector<SpecularLeaf> leaves{};

  bool ends_here(const SpecularLeaf& leaf) const {
    return !guide ||
           (leaf.chain.size() == guide->chain.size() && leaf.kind == guide->kind && leaf.light == guide->light);
  }

  void add(SpecularLeaf leaf) {
    if (!ends_here(leaf)) return;
    place_leaf(first, leaf);
    leaves.push_back(std::move(leaf));
  }

  /// Adds the lights with an area that the ray passes before a distance and that do not end it. Media before a light dim it.
  void add_lights(const Ray& ray, double distance, const SpecularLeaf& leaf) {
    for (const int i : scene.emitters.lights_on_way()) {
      const auto& light = std::get<RectangleLight>(scene.emitters.lights()[size_t(i)]);
      const auto met = meet(light, ray);
      if (!met || met->distance >= distance) continue;
      SpecularLeaf here = leaf;
      here.kind = LeafKind::light;
      here.light = i;
      here.weight *= scene.accelerator.transmittance(ray, met->distance);
      here.start.point.position = ray.origin + ray.direction * met->distance;
      here.start.point.geometric_normal = normalize(cross(light.edge_u, light.edge_v));
      add(std::move(here));
    }
  }

  /// Another ray passes the veils that the guide passed, whose light was drawn then, and meets those that the guide met.
  Veils veils_before(int depth) const {
    if (!guide) return {.has_media = false};  // particles are added beside what is behind them
    const auto n = size_t(depth) - 1;
    return {Veils::Kind::passed, n < guide->chain.size() ? guide->chain[n].point.mesh : guide->start.point.mesh};
  }

  /// Follows a ray from the end of the chain of `leaf`, the branch so far.
  void follow(const Ray& ray, double index, const SpecularLeaf& leaf) {
    ++counts.rays;
    const int depth = int(leaf.chain.size()) + 1;
    const auto hit = scene.accelerator.closest_hit(ray, Aim::exact, veils_before(depth));
    SpecularLeaf here = leaf;
    here.start.outgoing = -ray.direction;
    here.start.depth = depth;
    here.start.index = index;
    const double distance = hit ? hit->distance : std::numeric_limits<double>::infinity();
    if (const auto particle = scene.accelerator.particle_before(ray, distance);
        particle && depth <= scene.params.max_depth) {
      SpecularLeaf in_medium = here;
      in_medium.start.point = particle->point;
      in_medium.weight *= particle->weight;
      add(std::move(in_medium));
    }
    if (depth > 1) add_lights(ray, hit ? distance + hit->point.clearance : distance, here);
    here.weight *= scene.accelerator.transmittance(ray, distance);
    if (!hit) {
      here.kind = LeafKind::beyond;
      if (depth > 1 || scene.params.shows_background) add(std::move(here));
      return;
    }
    if (hit->point.light >= 0) {
      here.start.point = hit->point;
      add(std::move(here));
      return;
    }
    if (depth > scene.params.max_depth) {
      counts.cut += guide == nullptr;
      return;
    }
    const Material& material = scene.scene.materials[size_t(hit->point.material)];
    here.start.point = shading_point(material, hit->point);
    const Bsdf bsdf = make_bsdf(material, here.start.point, scene.lines);
    const LobeSet lobes = lobes_of(bsdf);
    SpecularBranches branches;
    if (!lobes.has_diffuse && !lobes.has_glossy) branches = specular_branches(bsdf, -ray.direction);
    if (branches.count == 0) return add(std::move(here));
    if (max_component(emitted_radiance(material, here.start.point, scene.lines)) > 0) {
      SpecularLeaf glow = here;
      glow.kind = LeafKind::glow;
      add(std::move(glow));
    }
    const SurfacePoint point = here.start.point;
    for (int i = 0; i < branches.count; ++i) {
      const BsdfSample& way = branches.ways[size_t(i)];
      if (guide && (guide->chain.size() < size_t(depth) ||
                    guide->chain[size_t(depth) - 1].is_transmission != way.is_transmission))
        continue;
      SpecularLeaf next = here;
      next.weight = here.weight * way.weight;
      const SpecularVertex vertex = specular_vertex(scene.scene, point, ray.direction, way, index, scene.lines);
      // Inside glass radiance is n² times as large as outside: n²·weight is the fraction of the light.
      const double beyond = vertex.index_after();
      if (max_component(next.weight) * beyond * beyond < least_weight) continue;
      next.phase = leaf.phase + way.phase;
      if (next.start.seen)
        next.start.seen->pass(polarization_of(bsdf, -ray.direction, way.direction, Lobe::specular), -ray.direction);
      next.start.state = scene.automaton.step(leaf.start.state, PathEvent::specular);
      if (scene.automaton.is_dead(next.start.state)) continue;
      next.chain.push_back(vertex);
      const double side = way.is_transmission ? -1 : 1;
      const Vec3 start = point.position + point.geometric_normal * (side * point.clearance);
      follow({start, way.direction}, beyond, next);
    }
  }
};

Walk walk(const PathScene& scene, const Ray& ray, const SpecularLeaf* guide, PathCounts& counts) {
  Walk w{scene, ray, guide, counts};
  SpecularLeaf root;
  root.start.state = scene.automaton.start();
  if (scene.detector) root.start.seen = row_of(*scene.detector, -ray.direction);
  w.follow(ray, 1, root);
  return w;
}

/// Whether the mirrors and glass of the chain are flat where the ray meets them, and next to that place.
bool is_flat(const Scene& scene, const std::vector<SpecularVertex>& chain) {
  return std::all_of(chain.begin(), chain.end(), [&](const SpecularVertex& vertex) {
    return scene.meshes[vertex.point.mesh].normals.empty() &&
           !scene.materials[size_t(vertex.point.material)].normal_map;
  });
}

}  // namespace

bool shows_the_same(const PathScene& scene, const SpecularLeaf& found, const SpecularLeaf& model, const Ray& ray) {
  if (model.kind == LeafKind::beyond) return true;
  const double reach = model.optical_path;
  const SurfacePoint& there = model.start.point;
  const Vec3 place = found.start.point.position;
  if (length(place - there.position) > 0.01 * reach) return false;
  if (!is_flat(scene.scene, model.chain))
    return std::abs(dot(place - there.position, there.geometric_normal)) <= 1e-3 * reach;
  const auto expected = retrace(model, ray);
  if (!expected) return false;
  const double rounding = 4 * there.clearance + 1e-5 * reach;
  return length(place - expected->place) <= rounding + 0.1 * length(expected->place - there.position);
}

std::vector<SpecularLeaf> follow_specular(const PathScene& scene, const Ray& ray, PathCounts& counts) {
  return walk(scene, ray, nullptr, counts).leaves;
}

std::optional<SpecularLeaf> follow_like(const PathScene& scene, const Ray& ray, const SpecularLeaf& model,
                                        PathCounts& counts) {
  auto leaves = walk(scene, ray, &model, counts).leaves;
  if (leaves.empty()) return std::nullopt;
  return std::move(leaves.front());
}

}  // namespace holotrace
