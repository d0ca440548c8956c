#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>

#include "holotrace/trace/geometry/light_surfaces.h"
#include "holotrace/trace/shared/lanes.h"

namespace holotrace {

/// A ray that ends at a place that is rounded ends this share of the place's distance from the centre before it, so that
/// what lies at the place is not in its way.
inline constexpr double end_rounding = 2e-6;

/// Rays that start outside a sphere are traced from it on. It is so much larger than the one around all surfaces.
inline constexpr double sphere_margin = 1.001;

/// Rays that are traced together, as Embree takes them, and which of them are: −1, or 0 for the others.
struct RayPacket {
  RTCRayHit16 query;
  alignas(64) std::array<int, most_together> valid;
  Lane skipped;  ///< length of each ray before the sphere around the scene, in units
};

/// Makes the rays of `asked` ready, all of them in vector lanes, as Accelerator does for one: they end before the
/// rounding of their end, and those that miss the sphere around the scene are left out.
void fill_packet(const RayLanes& rays, uint32_t asked, const ScenePrecision& precision, RayPacket& packet);

}  // namespace holotrace
