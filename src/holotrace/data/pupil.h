#pragma once

#include "holotrace/base/vec.h"

namespace holotrace {

/// The round entrance of an eye or a camera, parallel to the panel and in front of it; light beside it is blocked.
struct Pupil {
  Vec3 centre;          ///< [m], z > 0
  double diameter = 0;  ///< [m]
};

}  // namespace holotrace
