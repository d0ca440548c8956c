#pragma once

#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/shared/lanes.h"

namespace holotrace {

/// Emitting rectangles or triangles, of which each of several paths samples one.
struct LightLanes {
  LaneVectors corner, edge_u, edge_v;  ///< [m]; edge_u × edge_v points to where it shines
  Lane per_size;                       ///< 1/|edge_u × edge_v| [1/m²]
  Lane density;                        ///< of places on the emitter [1/m²]
  Lane size;                           ///< no corner is farther from a place on the emitter [m]
  Lane two_sided;                      ///< 1: it shines to both sides; 0: to one
  LaneVectors radiance;                ///< at the lines [W/m²/sr]
  bool are_triangles =
      false;  ///< places (u, v) are √u·((1 − v)·edge_u + v·edge_v) from the corner, not u·edge_u + v·edge_v
  bool are_surfaces = true;  ///< rays meet the emitter
  double lift = 0;           ///< of that surface (light_lifts) [m]
};

/// Numbers in [0, 1) that select the places on them.
struct PlaceLanes {
  Lane u, v;

  void set(size_t i, Vec2 place) { u[i] = place.x, v[i] = place.y; }
};

/// One rectangle for all paths.
LightLanes lanes_of(const RectangleLight& light, double lift);

}  // namespace holotrace
