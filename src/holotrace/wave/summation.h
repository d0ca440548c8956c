#pragma once

#include <optional>
#include <string>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Which of the fast summations may take part: tiles alone; `planes`, with tiles for the waves too near for it; or the
/// one of the two that is expected to take less work.
enum class Approach { tiled, planes, cheapest };

/// What sum_tiled.h and sum_planes.h have in common: for the panel, or one part of it after the other where waves have
/// amplitudes of their own there, a plan whose measured error meets the tolerance, its sum, and a look at the result:
/// where waves turn out to cancel, so that their errors weigh more, the sum is made again by a finer plan.
///
/// Facts: method, how (the plan of the part with the greatest error), expected_error, predicted_seconds (cost_model.h).
/// @return  no field where no plan meets the tolerance; `reachable` is then set to one that does
std::optional<Field> try_sum(const Sources& sources, const Grid& grid, double tolerance, Approach approach,
                             double& reachable, const Observer& observer);

/// The same where one method is asked for. @throws Error where no plan of it meets the tolerance
Field sum_within(const Sources& sources, const Grid& grid, double tolerance, Approach approach,
                 const Observer& observer);

/// What try_sum would do, without the sum: the plan of its first round.
struct SumForecast {
  double seconds = 0;  ///< by the cost model, without the time that planning takes
  std::string method;  ///< "tiled" or "planes"; "": no plan meets the tolerance
};

/// @throws Error  as try_sum does
SumForecast forecast_sum(const Sources& sources, const Grid& grid, double tolerance, Approach approach);

}  // namespace holotrace
