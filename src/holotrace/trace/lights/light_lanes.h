#pragma once

#include "holotrace/base/vec.h"
#include "holotrace/trace/shared/lanes.h"

namespace holotrace {

/// Samples of emitting rectangles or triangles, one for each of several paths, before it is known how each surface sees
/// them. `sample_lights` (trace/paths/diffuse_lanes.h) makes the rest.
struct LightLanes {
  LaneVectors corner, edge_u, edge_v;  ///< [m]; edge_u × edge_v points to where it shines
  Lane per_size;                       ///< 1/|edge_u × edge_v| [1/m²]
  Lane density;                        ///< of places on the emitter [1/m²]
  Lane size;                           ///< no corner is farther from a place on the emitter [m]
  Lane two_sided;                      ///< 1: it shines to both sides; 0: to one
  LaneVectors radiance;                ///< at the lines [W/m²/sr]
  Lane u, v;                           ///< numbers in [0, 1) that select the place
  bool are_triangles = false;          ///< u selects the row, parallel to edge_v − edge_u, of places on a triangle
  bool are_surfaces = true;            ///< rays meet the emitter
  double lift = 0;                     ///< Accelerator::lift_of [m]
};

}  // namespace holotrace
