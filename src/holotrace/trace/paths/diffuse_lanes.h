#pragma once

#include <cstdint>

#include "holotrace/base/vec.h"
#include "holotrace/trace/lights/light.h"
#include "holotrace/trace/shared/lanes.h"
#include "holotrace/trace/shared/ray.h"

// What paths do on diffuse surfaces that only reflect, for up to most_together of them in vector lanes. Of all arrays, the
// first `count` numbers are used.

namespace holotrace {

/// Surfaces that paths have reached.
struct DiffuseSurfaces {
  int count = 0;
  LaneVectors position;                  ///< [m]
  LaneVectors start;                     ///< where rays leave it (Accelerator::leave) [m]
  LaneVectors normal, geometric_normal;  ///< as of SurfacePoint
  Lane clearance;                        ///< as of SurfacePoint [m]

  /// The surface of one path. Its other members are not known.
  SurfacePoint point(size_t i) const {
    SurfacePoint point;
    point.position = position[i];
    point.normal = normal[i];
    point.geometric_normal = geometric_normal[i];
    point.clearance = clearance[i];
    return point;
  }
};

/// Samples of a light, as sample_light, eval, pdf and the shadow ray of direct_light.h are for one path.
struct LightSamples {
  LaneVectors direction;  ///< of the shadow ray, unit
  Lane distance;          ///< its length [m]
  Lane share;  ///< the reflected light, weighted by the power heuristic, over reflectance times radiance; 0: no light
};

/// @param centre  of the scene: the rounding of a place grows with its distance from it (ScenePrecision)
void sample_lights(const DiffuseSurfaces& at, const LightLanes& light, const PlaceLanes& places, Vec3 centre,
                   LightSamples& samples);

/// Directions that the surfaces draw, as `sample` of diffuse_bsdf.h draws one.
struct DiffuseSamples {
  LaneVectors direction;  ///< unit
  Lane pdf;               ///< [1/sr]; 0: the direction is into the surface, and the path ends
};

/// @param u, v  numbers in [0, 1), in units of 2⁻³²
void sample_directions(const DiffuseSurfaces& at, const uint32_t* u, const uint32_t* v, DiffuseSamples& samples);

}  // namespace holotrace
