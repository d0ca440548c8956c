#include "holotrace/trace/paths/specular_chain.h"

#include <cmath>

#include "holotrace/trace/materials/bsdf.h"

namespace holotrace {

namespace {

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

}  // namespace

SpecularVertex specular_vertex(const Scene& scene, const SurfacePoint& point, Vec3 direction, const BsdfSample& branch,
                               double index, const Lines& lines) {
  const MediumIndices media = media_at(scene.materials[size_t(point.material)], point, lines.wavelengths[0]);
  // If one surface separates two media, the index on the incoming side is that of the ray's medium.
  const double near = media.near == media.far ? index : media.near, far = media.near == media.far ? index : media.far;
  const Vec3 side = point.geometric_normal,
             normal = normal_between(direction, branch.direction, branch.is_transmission, near, far, side);
  const Vec3 turn = normal - normal_at(scene.meshes[point.mesh], point.triangle, point.position, side);
  return {point, normal, turn, branch.is_transmission, near, far};
}

std::optional<double> distance_to_plane(const Ray& ray, Vec3 place, Vec3 normal) {
  const double along = dot(ray.direction, normal);
  if (along == 0) return std::nullopt;
  return dot(place - ray.origin, normal) / along;
}

std::optional<RayEnd> retrace(const Scene& scene, std::span<const SpecularVertex> chain, Ray ray) {
  RayEnd end;
  for (const SpecularVertex& vertex : chain) {
    const SurfacePoint& point = vertex.point;
    const auto distance = distance_to_plane(ray, point.position, point.geometric_normal);
    if (!distance) return std::nullopt;
    end.optical_path += vertex.near * *distance;
    end.index = vertex.index_after();
    ray.origin = ray.origin + ray.direction * *distance;
    const Mesh& mesh = scene.meshes[point.mesh];
    const Vec3 normal =
        mesh.normals.empty()
            ? vertex.normal
            : normalize(vertex.turn + normal_at(mesh, point.triangle, ray.origin, point.geometric_normal));
    const auto next = deflect(vertex, ray.direction, normal);
    if (!next) return std::nullopt;
    ray.direction = normalize(*next);
  }
  end.place = ray.origin;
  end.direction = ray.direction;
  return end;
}

std::optional<RayEnd> retrace(const Scene& scene, std::span<const SpecularVertex> chain, const Ray& ray, Vec3 place,
                              Vec3 normal) {
  auto end = retrace(scene, chain, ray);
  if (!end) return std::nullopt;
  const auto distance = distance_to_plane({end->place, end->direction}, place, normal);
  if (!distance) return std::nullopt;
  end->optical_path += end->index * *distance;
  end->place += end->direction * *distance;
  return end;
}

}  // namespace holotrace
