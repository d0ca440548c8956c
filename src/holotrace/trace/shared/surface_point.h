#pragma once

#include <cstdint>

#include "holotrace/base/vec.h"

namespace holotrace {

/// A point of a surface, as materials and lights need it. Normals are unit vectors on the side that the path
/// came from.
struct SurfacePoint {
  Vec3 position;                    ///< [m]
  Vec3 geometric_normal;            ///< normal of the triangle
  Vec3 normal;                      ///< interpolated, for shading
  Vec2 uv;                          ///< 0 without a texture
  Vec3 tangent_u, tangent_v;        ///< ∂position/∂u and ∂position/∂v [m]; 0 without a normal map
  Vec3 colour{1, 1, 1};             ///< colour of the vertices, interpolated
  int material = 0;                 ///< index into Scene::materials (material_at); −1: the surface of a light
  int light = -1;                   ///< index into Scene::lights, on the surface of a light
  bool is_front = true;             ///< the path came from the side that sees the triangle counter-clockwise
  uint32_t mesh = 0, triangle = 0;  ///< numbers in Scene::meshes; surfaces of light_surfaces come after them
  double clearance = 0;             ///< offset with which a ray must start to avoid meeting the surface again [m]
};

}  // namespace holotrace
