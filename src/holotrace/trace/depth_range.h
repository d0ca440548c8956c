#pragma once

#include <optional>

#include "holotrace/data/grid.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// Distances from the panel between which nearly all visible surfaces and luminous points of a scene lie [m].
struct DepthRange {
  double nearest = 0, farthest = 0;
};

/// The depths of what the panel shows inside its own window: first hits of rays from five places of the panel, in its
/// diffraction cone, that lie within the panel's width and height. The 0.5 % nearest and farthest hits are left out.
/// What a mirror or a glass shows lies at the depth of that surface. None if nothing is there.
/// @throws Error  as Accelerator does
std::optional<DepthRange> depth_range(const Scene& scene, const Grid& panel, double wavelength);

}  // namespace holotrace
