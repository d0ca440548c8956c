#include "holotrace/slm/encode/reference_wave.h"

#include "holotrace/base/cycles.h"

namespace holotrace {

ReferenceWave reference_wave(Vec2 carrier, const Grid& grid, bool is_conjugate) {
  const double sign = is_conjugate ? -1 : 1;
  ReferenceWave wave;
  for (int i = 0; i < grid.nx; ++i) wave.along_x.push_back(cis_cycles(sign * carrier.x * grid.x(i)));
  for (int j = 0; j < grid.ny; ++j) wave.along_y.push_back(cis_cycles(sign * carrier.y * grid.y(j)));
  return wave;
}

}  // namespace holotrace
