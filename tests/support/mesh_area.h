#pragma once

#include "holotrace/io/mesh/mesh_file.h"

namespace holotrace::test {

/// Area of all triangles of a model [m²].
inline double area(const LoadedModel& model) {
  double sum = 0;
  for (const Mesh& mesh : model.meshes)
    for (auto [a, b, c] : mesh.triangles) {
      const Vec3 p = mesh.positions[a];
      sum += length(cross(mesh.positions[b] - p, mesh.positions[c] - p)) / 2;
    }
  return sum;
}

}  // namespace holotrace::test
