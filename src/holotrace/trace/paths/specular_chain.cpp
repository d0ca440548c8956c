#include "holotrace/trace/paths/specular_chain.h"

#include <cmath>
#include <utility>

#include "holotrace/trace/materials/bsdf.h"

namespace holotrace {

namespace {

/// The normal for which the law of reflection or Snell's law turns one direction into the other.
Vec3 normal_between(Vec3 in, Vec3 out, bool is_transmission, double near, double far, Vec3 side) {
  const Vec3 change = is_transmission ? out * far - in * near : out - in;
  const double size = length(change);
  return size > 1e-9 ? change * (std::copysign(1.0, dot(change, side)) / size) : side;
}

/// How the interpolated normal changes over the triangle's plane.
void set_bend(const Mesh& mesh, SpecularVertex& vertex) {
  if (mesh.normals.empty()) return;
  const SurfacePoint& point = vertex.point;
  const auto [i, j, k] = mesh.triangles[point.triangle];
  const Vec3 a = mesh.positions[i], ab = mesh.positions[j] - a, ac = mesh.positions[k] - a, across = cross(ab, ac);
  const double squared = dot(across, across);
  if (squared == 0) return;
  // Barycentric coordinates of a place x are slope_u·(x − a) and slope_v·(x − a).
  vertex.slope_u = cross(ac, across) / squared;
  vertex.slope_v = cross(across, ab) / squared;
  const Vec3 along_u = mesh.normals[j] - mesh.normals[i], along_v = mesh.normals[k] - mesh.normals[i];
  const Vec3 here = mesh.normals[i] + along_u * dot(vertex.slope_u, point.position - a) +
                    along_v * dot(vertex.slope_v, point.position - a);
  const double size = std::copysign(length(here), dot(here, point.geometric_normal));
  if (size == 0) return;
  vertex.bend_u = along_u / size;
  vertex.bend_v = along_v / size;
}

/// Moves a ray to the plane through a place; the distance, or none if the ray is parallel to the plane.
std::optional<double> go_to_plane(Ray& ray, Vec3 place, Vec3 normal, std::span<RayChange> changes) {
  const double along = dot(ray.direction, normal);
  if (along == 0) return std::nullopt;
  const double distance = dot(place - ray.origin, normal) / along;
  ray.origin += ray.direction * distance;
  for (RayChange& change : changes) {
    change.place += change.direction * distance;
    change.place += ray.direction * (-dot(change.place, normal) / along);
  }
  return distance;
}

/// Turns a ray by the law of reflection or Snell's law,
///
///     d' = d + 2cn    or    d' = rd + (rc − s)n,  c = −d·n,  r = n₁/n₂,  s = √(1 − r²(1 − c²)),
///
/// and its derivatives; false at total reflection.
bool deflect(const SpecularVertex& vertex, Ray& ray, std::span<RayChange> changes) {
  if (vertex.is_transmission && vertex.near == vertex.far) return true;
  const Vec3 from = ray.origin - vertex.point.position, d = ray.direction;
  const Vec3 bent =
      vertex.normal + vertex.bend_u * dot(vertex.slope_u, from) + vertex.bend_v * dot(vertex.slope_v, from);
  const double size = length(bent), r = vertex.near / vertex.far;
  const Vec3 n = bent / size;
  const double c = -dot(d, n), squared = 1 - r * r * (1 - c * c);
  if (vertex.is_transmission && !(squared > 0)) return false;
  const double s = vertex.is_transmission ? std::sqrt(squared) : 0;
  for (RayChange& change : changes) {
    const Vec3 bend =
        vertex.bend_u * dot(vertex.slope_u, change.place) + vertex.bend_v * dot(vertex.slope_v, change.place);
    const Vec3 dn = (bend - n * dot(n, bend)) / size;
    const double dc = -dot(change.direction, n) - dot(d, dn);
    change.direction = vertex.is_transmission
                           ? change.direction * r + n * (r * dc - r * r * c * dc / s) + dn * (r * c - s)
                           : change.direction + n * (2 * dc) + dn * (2 * c);
  }
  ray.direction = normalize(vertex.is_transmission ? d * r + n * (r * c - s) : d + n * (2 * c));
  return true;
}

}  // namespace

SpecularVertex specular_vertex(const Scene& scene, const SurfacePoint& point, Vec3 direction, const BsdfSample& branch,
                               double index, const Lines& lines) {
  const MediumIndices media = media_at(scene.materials[size_t(point.material)], point, lines.of_glass());
  // If one surface separates two media, the index on the incoming side is that of the ray's medium.
  const double near = media.near == media.far ? index : media.near, far = media.near == media.far ? index : media.far;
  SpecularVertex vertex{
      point,
      normal_between(direction, branch.direction, branch.is_transmission, near, far, point.geometric_normal),
      branch.is_transmission,
      near,
      far,
      {},
      {},
      {},
      {}};
  set_bend(scene.meshes[point.mesh], vertex);
  return vertex;
}

std::vector<SpecularVertex> reverse(std::span<const SpecularVertex> chain) {
  std::vector<SpecularVertex> back(chain.rbegin(), chain.rend());
  for (SpecularVertex& vertex : back)
    if (vertex.is_transmission) {
      vertex.normal = -vertex.normal;
      vertex.bend_u = -vertex.bend_u;
      vertex.bend_v = -vertex.bend_v;
      std::swap(vertex.near, vertex.far);
    }
  return back;
}

std::optional<RayEnd> retrace(std::span<const SpecularVertex> chain, const Ray& ray, std::span<RayChange> changes) {
  Ray on = ray;
  RayEnd end;
  for (const SpecularVertex& vertex : chain) {
    const auto distance = go_to_plane(on, vertex.point.position, vertex.point.geometric_normal, changes);
    if (!distance || !deflect(vertex, on, changes)) return std::nullopt;
    end.optical_path += vertex.near * *distance;
    end.index = vertex.index_after();
  }
  end.place = on.origin;
  end.direction = on.direction;
  return end;
}

std::optional<RayEnd> retrace(std::span<const SpecularVertex> chain, const Ray& ray, Vec3 place, Vec3 normal,
                              std::span<RayChange> changes) {
  auto end = retrace(chain, ray, changes);
  if (!end) return std::nullopt;
  Ray on{end->place, end->direction};
  const auto distance = go_to_plane(on, place, normal, changes);
  if (!distance) return std::nullopt;
  end->optical_path += end->index * *distance;
  end->place = on.origin;
  return end;
}

}  // namespace holotrace
