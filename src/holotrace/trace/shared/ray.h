#pragma once

#include "holotrace/base/vec.h"

namespace holotrace {

/// A half line.
struct Ray {
  Vec3 origin;     ///< [m]
  Vec3 direction;  ///< unit
};

}  // namespace holotrace
