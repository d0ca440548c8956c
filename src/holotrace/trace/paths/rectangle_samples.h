#pragma once

#include <array>
#include <cstdint>

#include "holotrace/base/vec.h"
#include "holotrace/trace/geometry/accelerator.h"

namespace holotrace {

/// A rectangle light and a diffuse surface that only reflects. Places are relative to the point of the surface [m].
struct RectangleAndSurface {
  Vec3 corner{}, edge_u{}, edge_v{};
  bool is_visible = true;
  double lift = 0;                    ///< of the light's surface (Accelerator::lift_of)
  Vec3 normal{}, geometric_normal{};  ///< of the surface
  double clearance = 0;               ///< SurfacePoint::clearance
  Vec3 centre{};                      ///< of the scene
};

/// Samples of the light for several paths, as sample_light, eval, pdf and the shadow ray of direct_light.h are for one.
struct RectangleSamples {
  std::array<double, most_shadow_rays> x, y, z;   ///< direction of the shadow ray
  std::array<double, most_shadow_rays> distance;  ///< its length [m]
  /// The light that is reflected, weighted by the power heuristic, over reflectance times radiance; 0: no light.
  std::array<double, most_shadow_rays> share;
};

/// @param u, v  most_shadow_rays places on the rectangle, in units of 2⁻³² of its edges
void sample_rectangle(const RectangleAndSurface& pair, const uint32_t* u, const uint32_t* v, RectangleSamples& samples);

}  // namespace holotrace
