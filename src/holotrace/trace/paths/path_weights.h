#pragma once

#include "holotrace/base/vec.h"
#include "holotrace/data/path_expression.h"
#include "holotrace/trace/materials/lobe.h"

namespace holotrace {

/// Whether no component carries light.
inline bool is_black(Vec3 v) { return v.x <= 0 && v.y <= 0 && v.z <= 0; }

/// The power heuristic: the weight of light found with density `own` if another technique has the density `other`.
inline double shared_weight(double own, double other) {
  const double ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

/// The letter of path expressions for a lobe.
inline PathEvent event_of(Lobe lobe) {
  return lobe == Lobe::diffuse ? PathEvent::diffuse : lobe == Lobe::glossy ? PathEvent::glossy : PathEvent::specular;
}

}  // namespace holotrace
