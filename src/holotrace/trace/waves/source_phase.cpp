#include "holotrace/trace/waves/source_phase.h"

#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/splitmix.h"
#include "holotrace/base/units.h"
#include "holotrace/data/sources.h"

namespace holotrace {

double cell_side(const TraceParams& params, const Grid& panel) {
  require(std::isfinite(params.grain) && params.grain >= 0,
          "expected a grain of 0 m (the pixel pitch) or more, got {} m", params.grain);
  return params.grain > 0 && params.phase != SourcePhase::constant ? params.grain : panel.pitch;
}

SurfaceCell surface_cell(Vec3 position, double side) {
  // Irrational fractions: those of √2, √3 and √5.
  const double offsets[3] = {0.41421356, 0.73205081, 0.23606798};
  const double coordinates[3] = {position.x, position.y, position.z};
  double centre[3];
  uint64_t key = 0;
  for (int i = 0; i < 3; ++i) {
    const double cell = std::floor(coordinates[i] / side + offsets[i]);
    centre[i] = (cell + 0.5 - offsets[i]) * side;
    key = mix(key + uint64_t(int64_t(cell)) * splitmix_step + 0x632be59bd9b4e019);
  }
  return {key == Sources::no_phase_key ? 0 : key, {centre[0], centre[1], centre[2]}};
}

}  // namespace holotrace
