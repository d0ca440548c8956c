#pragma once

#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/grid.h"

namespace holotrace {

/// What a hologram is to show in one plane: the modulus of the field there, whatever its phase and scale.
struct TargetPlane {
  double z = 0;              ///< of the plane [m]: < 0 behind the panel (virtual image), > 0 before it (real)
  double wavelength = 0;     ///< [m]
  Array2D<float> amplitude;  ///< ≥ 0, on the panel's own pixels, shape (ny, nx)
  Array2D<float> weight;     ///< ≥ 0 of the squared error there, same shape: 0 where any light may fall; empty: 1
};

}  // namespace holotrace
