#pragma once

#include <vector>

#include "holotrace/data/summation_rates.h"

namespace holotrace {

/// Work and the time that it took on one thread.
struct TimedWork {
  SummationWork work;
  double seconds = 0;
};

/// The rates with which the cost model (wave/shared/cost_model.h) fits the measured times best:
///
///     min over x ≥ 0 of Σᵢ (Σₖ countᵢₖ·xₖ/tᵢ − 1)²,   rateₖ = 1/xₖ
///
/// A kind of work whose time cannot be separated gets a hundredth of the run in which its share is largest. A kind that
/// was not timed gets its default rate times the mean factor (geometric) between measured and default rates of the
/// other kinds.
///
/// @param timed  at least one run, each with some work and t > 0 [s]
/// @throws Error for a run without work or time
SummationRates fit_rates(const std::vector<TimedWork>& timed);

}  // namespace holotrace
