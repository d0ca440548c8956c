#include "holotrace/wave/sum_tiled.h"

#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/wave/summation.h"

namespace holotrace {

Field sum_tiled(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer) {
  double reachable = 0;
  std::optional<Field> field = try_sum(sources, grid, tolerance, Approach::tiled, reachable, observer);
  require(
      field.has_value(),
      "expected a tolerance that tiles can meet, {:.1e} or more for these sources, got {:.1e}; use the method exact",
      reachable, tolerance);
  return std::move(*field);
}

}  // namespace holotrace
