#pragma once

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/data/scene.h"

// Functions shared by the functions that make shapes (shapes.h).

namespace holotrace {

/// @throws Error unless the side of a shape is above 0 m
inline void check_side(double side, const char* shape, const char* name) {
  require(std::isfinite(side) && side > 0, "expected a {} of {} above 0 m, got {} m", name, shape, side);
}

/// Adds a flat face a, a + u, a + u + v, a + v with the normal u × v and texture coordinates (0,0) … (1,1).
inline void add_face(Mesh& mesh, Vec3 a, Vec3 u, Vec3 v) {
  const auto first = uint32_t(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {a, a + u, a + u + v, a + v});
  mesh.normals.insert(mesh.normals.end(), 4, normalize(cross(u, v)));
  mesh.texture_coordinates.insert(mesh.texture_coordinates.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

}  // namespace holotrace
