#include "holotrace/trace/paths/specular.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/materials/bsdf.h"

namespace holotrace {

namespace {

constexpr double least_weight = 1e-3;

/// The interpolated normal of a triangle at a place of its plane, also beyond its edges, turned to the side of
/// `side`; `side` itself if the triangle is flat.
Vec3 normal_at(const Mesh& mesh, uint32_t triangle, Vec3 place, Vec3 side) {
  if (mesh.normals.empty()) return side;
  const auto [i, j, k] = mesh.triangles[triangle];
  const Vec3 a = mesh.positions[i], ab = mesh.positions[j] - a, ac = mesh.positions[k] - a, normal = cross(ab, ac);
  const double area = dot(normal, normal);
  if (area == 0) return side;
  const double b1 = dot(cross(place - a, ac), normal) / area, b2 = dot(cross(ab, place - a), normal) / area;
  const Vec3 smooth = mesh.normals[i] * (1 - b1 - b2) + mesh.normals[j] * b1 + mesh.normals[k] * b2;
  const double size = length(smooth);
  return size > 0 ? smooth * (std::copysign(1.0, dot(smooth, side)) / size) : side;
}

/// The direction after a surface by the law of reflection or Snell's law; none at total reflection.
std::optional<Vec3> deflect(const SpecularVertex& vertex, Vec3 direction, Vec3 normal) {
  const double cosine = -dot(direction, normal);
  if (!vertex.is_transmission) return direction + normal * (2 * cosine);
  if (vertex.near == vertex.far) return direction;
  const double ratio = vertex.near / vertex.far, squared = 1 - ratio * ratio * (1 - cosine * cosine);
  if (squared < 0) return std::nullopt;
  return direction * ratio + normal * (ratio * cosine - std::sqrt(squared));
}

/// The normal for which the law of reflection or Snell's law turns one direction into the other.
Vec3 normal_between(Vec3 in, Vec3 out, bool is_transmission, double near, double far, Vec3 side) {
  const Vec3 change = is_transmission ? out * far - in * near : out - in;
  const double size = length(change);
  return size > 1e-9 ? change * (std::copysign(1.0, dot(change, side)) / size) : side;
}

/// A ray at the end of a chain, from geometry alone.
struct RayEnd {
  Vec3 place, direction;
  double optical_path = 0;
};

std::optional<double> distance_to_plane(const Ray& ray, const SurfacePoint& point) {
  const double along = dot(ray.direction, point.geometric_normal);
  if (along == 0) return std::nullopt;
  return dot(point.position - ray.origin, point.geometric_normal) / along;
}

/// Traces a ray through the planes of a leaf's chain to the plane of its last surface.
std::optional<RayEnd> retrace(const Scene& scene, const SpecularLeaf& leaf, Ray ray) {
  RayEnd end;
  double index = 1;
  for (const SpecularVertex& vertex : leaf.chain) {
    const SurfacePoint& point = vertex.point;
    const auto distance = distance_to_plane(ray, point);
    if (!distance) return std::nullopt;
    index = vertex.near;
    end.optical_path += index * *distance;
    ray.origin = ray.origin + ray.direction * *distance;
    const Mesh& mesh = scene.meshes[point.mesh];
    const Vec3 change = normal_at(mesh, point.triangle, ray.origin, point.geometric_normal) -
                        normal_at(mesh, point.triangle, point.position, point.geometric_normal);
    const auto next = deflect(vertex, ray.direction, normalize(vertex.normal + change));
    if (!next) return std::nullopt;
    ray.direction = normalize(*next);
    if (vertex.is_transmission) index = vertex.far;
  }
  if (leaf.kind != LeafKind::beyond) {
    const auto distance = distance_to_plane(ray, leaf.start.point);
    if (!distance) return std::nullopt;
    end.optical_path += index * *distance;
    ray.origin = ray.origin + ray.direction * *distance;
  }
  end.place = ray.origin;
  end.direction = ray.direction;
  return end;
}

/// Curvature C of the wavefront at the ray's origin [1/m], positive if it diverges, in the axes x and y across the ray.
struct Curvature {
  double xx, xy, yy;
  Vec3 x, y;
  double twice_mean() const { return xx + yy; }
};

/// None if the chain cannot be traced for slightly displaced rays.
std::optional<Curvature> curvature_of(const Scene& scene, const SpecularLeaf& leaf, const Ray& ray, const RayEnd& end) {
  const double reach = std::max(std::abs(end.optical_path), 1e-6), step = 1e-6;  // of the reach, and in radians
  const Frame across = frame_from_normal(ray.direction);
  const Frame screen =
      frame_from_normal(leaf.kind == LeafKind::beyond ? end.direction : leaf.start.point.geometric_normal);
  const auto derivative = [&](Vec3 shift, Vec3 turn, double by) -> std::optional<Vec2> {
    const auto ahead = retrace(scene, leaf, {ray.origin + shift, normalize(ray.direction + turn)});
    const auto behind = retrace(scene, leaf, {ray.origin - shift, normalize(ray.direction - turn)});
    if (!ahead || !behind) return std::nullopt;
    const Vec3 change =
        leaf.kind == LeafKind::beyond ? ahead->direction - behind->direction : ahead->place - behind->place;
    return Vec2{dot(change, screen.x) / (2 * by), dot(change, screen.y) / (2 * by)};
  };
  const double shift = step * reach;
  const auto q1 = derivative(across.x * shift, {}, shift), q2 = derivative(across.y * shift, {}, shift);
  const auto d1 = derivative({}, across.x * step, step), d2 = derivative({}, across.y * step, step);
  if (!q1 || !q2 || !d1 || !d2) return std::nullopt;
  const double determinant = d1->x * d2->y - d2->x * d1->y;
  if (determinant == 0) return std::nullopt;
  const auto solved = [&](Vec2 q) {
    return Vec2{(d2->y * q.x - d2->x * q.y) / determinant, (d1->x * q.y - d1->y * q.x) / determinant};
  };
  const Vec2 c1 = solved(*q1), c2 = solved(*q2);
  return Curvature{c1.x, (c1.y + c2.x) / 2, c2.y, across.x, across.y};  // symmetric but for rounding
}

FocalLines lines_of(const Curvature& c) {
  const double mean = c.twice_mean() / 2, difference = std::hypot((c.xx - c.yy) / 2, c.xy);
  // The direction of the greater curvature; the focal line of the other one lies along it.
  const double angle = std::atan2(2 * c.xy, c.xx - c.yy) / 2;
  const Vec3 greater = c.x * std::cos(angle) + c.y * std::sin(angle),
             less = c.y * std::cos(angle) - c.x * std::sin(angle);
  const auto distance = [](double curvature) {
    return std::abs(curvature) > 1 / farthest_origin ? 1 / curvature : farthest_origin;
  };
  const double of_greater = distance(mean + difference), of_less = distance(mean - difference);
  if (std::abs(of_less) >= std::abs(of_greater)) return {of_less, of_greater, greater};
  return {of_greater, of_less, less};
}

/// Moves the leaf to the end of the chain traced in double, and computes its apparent distance.
void place_leaf(const Scene& scene, const Ray& ray, SpecularLeaf& leaf) {
  const auto end = retrace(scene, leaf, ray);
  if (end) {
    if (leaf.kind != LeafKind::beyond) leaf.start.point.position = end->place;
    leaf.start.outgoing = -end->direction;
    leaf.optical_path = end->optical_path;
  }
  if (leaf.chain.empty() && leaf.kind != LeafKind::beyond) {
    leaf.distance = leaf.optical_path;
    return;
  }
  const auto curvature = end ? curvature_of(scene, leaf, ray, *end) : std::nullopt;
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
    place_leaf(scene.scene, first, leaf);
    leaves.push_back(std::move(leaf));
  }

  /// Adds the lights with an area that the ray passes before a distance and that do not end it.
  void add_lights(const Ray& ray, double distance, const SpecularLeaf& leaf) {
    for (const int i : scene.emitters.lights_on_way()) {
      const auto& light = std::get<RectangleLight>(scene.emitters.lights()[size_t(i)]);
      const auto met = meet(light, ray);
      if (!met || met->distance >= distance) continue;
      SpecularLeaf here = leaf;
      here.kind = LeafKind::light;
      here.light = i;
      here.start.point.position = ray.origin + ray.direction * met->distance;
      here.start.point.geometric_normal = normalize(cross(light.edge_u, light.edge_v));
      add(std::move(here));
    }
  }

  /// Follows a ray from the end of the chain of `leaf`, the branch so far.
  void follow(const Ray& ray, double index, const SpecularLeaf& leaf) {
    ++counts.rays;
    const auto hit = scene.accelerator.closest_hit(ray);
    const int depth = int(leaf.chain.size()) + 1;
    SpecularLeaf here = leaf;
    here.start.outgoing = -ray.direction;
    here.start.depth = depth;
    here.start.index = index;
    if (depth > 1)
      add_lights(ray, hit ? hit->distance + hit->point.clearance : std::numeric_limits<double>::infinity(), here);
    if (!hit) {
      here.kind = LeafKind::beyond;
      if (depth > 1) add(std::move(here));
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
    const MediumIndices media = media_at(material, point, scene.lines.wavelengths[0]);
    // If one surface separates two media, the index on the incoming side is that of the ray's medium.
    const double near = media.near == media.far ? index : media.near, far = media.near == media.far ? index : media.far;
    for (int i = 0; i < branches.count; ++i) {
      const BsdfSample& way = branches.ways[size_t(i)];
      if (guide && (guide->chain.size() < size_t(depth) ||
                    guide->chain[size_t(depth) - 1].is_transmission != way.is_transmission))
        continue;
      SpecularLeaf next = here;
      next.weight = leaf.weight * way.weight;
      // Inside glass radiance is n² times as large as outside: n²·weight is the fraction of the light.
      const double beyond = way.is_transmission ? far : near;
      if (max_component(next.weight) * beyond * beyond < least_weight) continue;
      next.phase = leaf.phase + way.phase;
      next.start.state = scene.automaton.step(leaf.start.state, PathEvent::specular);
      if (scene.automaton.is_dead(next.start.state)) continue;
      next.chain.push_back(
          {point, normal_between(ray.direction, way.direction, way.is_transmission, near, far, point.geometric_normal),
           way.is_transmission, near, far});
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
  const auto expected = retrace(scene.scene, model, ray);
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
