#pragma once

#include <complex>
#include <vector>

#include "holotrace/base/vec.h"
#include "holotrace/data/grid.h"

namespace holotrace {

/// A plane wave at the pixels of a panel, exp(2πi(u·x + v·y)), as a product of a factor for each column and one for each
/// row (plane_wave of interference_kernel.h).
struct ReferenceWave {
  std::vector<std::complex<double>> along_x, along_y;
};

/// @param carrier       spatial frequency (u, v) [1/m]
/// @param is_conjugate  whether it is to interfere with the conjugate of a field instead of the field: since
///                      Re(U*·R*) = Re(U·R), that is the wave of the opposite carrier
ReferenceWave reference_wave(Vec2 carrier, const Grid& grid, bool is_conjugate);

}  // namespace holotrace
