#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/data/scene.h"
#include "holotrace/trace/shared/lines.h"
#include "holotrace/trace/shared/surface_point.h"

namespace holotrace {

/// A plane of a mesh that reflects as a mirror does: polished metal, smooth glass, a coat. Lights that no ray can meet shine by
/// it as their mirror images do.
struct FlatMirror {
  uint32_t mesh = 0;
  Vec3 place, normal;         ///< a point of the plane [m], and its unit normal
  std::vector<Light> images;  ///< mirror image of each light of the scene; rectangles as they are

  /// Whether a ray that met this point has met the plane.
  bool holds(const SurfacePoint& point) const;
};

/// Mirrors and glass between a surface and a light.
struct MirrorOnWay {
  int number = 0;  ///< of the way: a flat mirror, or one of the ways of caustic_light; from 1 on; 0: straight
  Vec3 phase{};    ///< that they add at the lines [rad]
};

/// The planes of all meshes that reflect, if there are lights that rays cannot meet. Meshes of more than 16 planes, and those with
/// smooth normals or a normal map, count as curved and have none.
std::vector<FlatMirror> flat_mirrors(const Scene& scene, const std::vector<Light>& lights, const Lines& lines);

}  // namespace holotrace
