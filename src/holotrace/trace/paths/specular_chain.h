#pragma once

#include <optional>
#include <span>

#include "holotrace/data/scene.h"
#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/shared/lines.h"
#include "holotrace/trace/shared/ray.h"
#include "holotrace/trace/shared/surface_point.h"

// Chains of mirrors and glass, traced in double at the planes of their triangles, and by geometry alone.

namespace holotrace {

/// A mirror or a smooth glass surface that a ray meets.
struct SpecularVertex {
  SurfacePoint point;
  Vec3 normal;           ///< unit normal on the ray's side, of the mirror or lens face that the ray met
  Vec3 turn;             ///< this normal less the triangle's interpolated normal there: a normal map, or rounding
  bool is_transmission;  ///< refracted, or straight through a pane
  double near, far;      ///< refractive index before the surface and behind it

  double index_after() const { return is_transmission ? far : near; }
};

/// The vertex of a ray of this direction that meets a point (shading_point) and leaves it by a branch.
/// @param index  refractive index of the medium that the ray comes through
SpecularVertex specular_vertex(const Scene& scene, const SurfacePoint& point, Vec3 direction, const BsdfSample& branch,
                               double index, const Lines& lines);

/// A ray at the end of a chain, from geometry alone.
struct RayEnd {
  Vec3 place, direction;    ///< [m]; unit
  double optical_path = 0;  ///< Σ n·d from the ray's origin [m]
  double index = 1;         ///< refractive index of the medium behind the chain
};

/// Distance along a ray to the plane through a place [m]; none if it is parallel to the plane.
std::optional<double> distance_to_plane(const Ray& ray, Vec3 place, Vec3 normal);

/// Traces a ray through the planes of a chain. The interpolated normals of their triangles are extended linearly
/// beyond the edges. The ray ends at the last surface, with the direction in which it leaves it; none if it meets a plane
/// nowhere or is totally reflected where the chain refracts.
std::optional<RayEnd> retrace(const Scene& scene, std::span<const SpecularVertex> chain, Ray ray);

/// The same, on to the plane through a place behind the chain.
std::optional<RayEnd> retrace(const Scene& scene, std::span<const SpecularVertex> chain, const Ray& ray, Vec3 place,
                              Vec3 normal);

}  // namespace holotrace
