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

/// A flat mirror between a surface and a light.
struct MirrorOnWay {
  int number = 0;  ///< from 1 on; 0: none
  Vec3 phase{};    ///< that it adds at the lines [rad]
};

struct FlatMirrors {
  std::vector<FlatMirror> planes;
  bool has_curved = false;  ///< whether there is also curved metal, or glass that refracts, which make no such images
};

/// The planes of all meshes that reflect, if there are lights that rays cannot meet. Meshes of more than 16 planes, and those with
/// smooth normals or a normal map, count as curved.
FlatMirrors flat_mirrors(const Scene& scene, const std::vector<Light>& lights, const Lines& lines);

}  // namespace holotrace
