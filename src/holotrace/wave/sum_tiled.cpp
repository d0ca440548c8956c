#include "holotrace/wave/sum_tiled.h"

#include "holotrace/wave/summation.h"

namespace holotrace {

Field sum_tiled(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer) {
  return sum_within(sources, grid, tolerance, Approach::tiled, observer).field;
}

}  // namespace holotrace
