#include "holotrace/wave/sum_planes.h"

#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/wave/summation.h"

namespace holotrace {

Field sum_planes(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer) {
  double reachable = 0;
  std::optional<Field> field = try_sum(sources, grid, tolerance, Approach::planes, reachable, observer);
  require(
      field.has_value(),
      "expected a tolerance that planes can meet, {:.1e} or more for these sources, got {:.1e}; use the method exact",
      reachable, tolerance);
  return std::move(*field);
}

}  // namespace holotrace
