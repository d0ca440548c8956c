#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/geometry/box_tree.h"
#include "holotrace/trace/shared/ray.h"

namespace holotrace {

/// A mesh whose vertices at one place, up to 1e-6 of its size, are one.
struct Welded {
  std::vector<Vec3> places;
  std::vector<uint32_t> number;  // of the place of each vertex
  size_t open_edges = 0;         // that do not belong to two triangles of opposite sense
};

/// What a region is bounded by.
struct MediumBoundary {
  int medium;  // −1: empty
  Box box;     // without a mesh
  const Mesh* mesh = nullptr;
  Welded welded{};
  float volume = 0;  // [m³]; in single precision volumes do not differ by rounding
  bool is_empty = false;
};

/// The boundaries of a scene in the order in which they count: smaller before larger ones, and of two that are as large a mesh
/// before a box, and one with a medium before an empty one. Glass without a medium that is not closed bounds nothing.
/// @throws Error, naming the medium and mesh, for a mesh around a medium that is not closed, or reaches through the plane of the
///         panel
std::vector<MediumBoundary> boundaries_of(const Scene& scene);

/// Whether the solid of a mesh absorbs by itself. A medium in it takes the place of that.
bool absorbs(const Material& material);

/// The absorption σ of such a solid [1/m]: the colour after a distance d is exp(−σ·d).
Vec3 absorption_of(const Material& solid, const Lines& lines);

}  // namespace holotrace
