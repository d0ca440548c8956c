#include "holotrace/wave/sum_planes.h"

#include "holotrace/wave/summation.h"

namespace holotrace {

Field sum_planes(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer) {
  return sum_within(sources, grid, tolerance, Approach::planes, observer).field;
}

}  // namespace holotrace
