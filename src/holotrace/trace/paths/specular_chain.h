#pragma once

#include <optional>
#include <span>
#include <vector>

#include "holotrace/data/scene.h"
#include "holotrace/trace/materials/lobe.h"
#include "holotrace/trace/shared/ray.h"

// Chains of mirrors and glass, traced in double at the planes of their triangles, and by geometry alone.

namespace holotrace {

/// A mirror or a smooth glass surface that a ray meets.
struct SpecularVertex {
  SurfacePoint point;
  Vec3 normal;           ///< unit normal on the ray's side, of the mirror or lens face that the ray met
  bool is_transmission;  ///< refracted, or straight through a pane
  double near, far;      ///< refractive index before the surface and behind it

  /// At x on the triangle's plane the normal is that of normal + bend_u·(slope_u·y) + bend_v·(slope_v·y), y = x − position:
  /// the interpolated normal, also beyond the edges. Zero for flat triangles.
  Vec3 bend_u, bend_v, slope_u, slope_v;

  double index_after() const { return is_transmission ? far : near; }
};

/// The vertex of a ray of this direction that meets a point (shading_point) and leaves it by a branch.
/// @param index  refractive index of the medium that the ray comes through
SpecularVertex specular_vertex(const Scene& scene, const SurfacePoint& point, Vec3 direction, const BsdfSample& branch,
                               double index, const Lines& lines);

/// The chain of a ray that comes back the same way.
std::vector<SpecularVertex> reverse(std::span<const SpecularVertex> chain);

/// A ray at the end of a chain, from geometry alone.
struct RayEnd {
  Vec3 place, direction;    ///< [m]; unit
  double optical_path = 0;  ///< Σ n·d from the ray's origin [m]
  double index = 1;         ///< refractive index of the medium behind the chain
};

/// Derivatives of a ray's place and direction by a coordinate of the ray.
struct RayChange {
  Vec3 place, direction;
};

/// Traces a ray through the planes of a chain, whose normals are extended linearly beyond the edges of the triangles. The ray
/// ends at the last surface, with the direction in which it leaves it; none if it meets a plane nowhere or is
/// totally reflected where the chain refracts.
///
/// @param changes  derivatives of the ray at its origin; at its end after the call
std::optional<RayEnd> retrace(std::span<const SpecularVertex> chain, const Ray& ray, std::span<RayChange> changes = {});

/// The same, on to the plane through a place behind the chain.
std::optional<RayEnd> retrace(std::span<const SpecularVertex> chain, const Ray& ray, Vec3 place, Vec3 normal,
                              std::span<RayChange> changes = {});

}  // namespace holotrace
