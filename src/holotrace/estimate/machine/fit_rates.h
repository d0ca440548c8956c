#pragma once

#include <vector>

#include "holotrace/data/summation_rates.h"

namespace holotrace {

/// Work that was timed on one thread.
struct TimedWork {
  SummationWork work;
  double seconds = 0;
};

/// The rates by which the cost model (wave/shared/cost_model.h) comes nearest to what was timed:
///
///     min over x ≥ 0 of Σᵢ (Σₖ countᵢₖ·xₖ/tᵢ − 1)²,   rateₖ = 1/xₖ
///
/// A kind of work that takes no time that can be told apart is given a hundredth of the run that it weighs most in. A
/// kind that was not timed keeps its default rate, times how much faster than its defaults the machine was in the
/// others (geometric mean).
///
/// @param timed  at least one, each with some work and t > 0 [s]
/// @throws Error for a run without work or time
SummationRates fit_rates(const std::vector<TimedWork>& timed);

}  // namespace holotrace
