#pragma once

#include "holotrace/data/summation_rates.h"
#include "holotrace/wave/propagate/propagator.h"

// What a propagation takes, from its plan (plan_propagator).

namespace holotrace {

/// Operations of the processor, without those that make the transfer function.
SummationWork propagation_work(const Propagator<float>& plan);

/// Seconds that the processor is expected to take, by that work and the rates of cost_model.h, with all of its threads.
/// The lines of a large field come from memory, for which those rates do not hold: 1.4 times as long.
double seconds_to_propagate(const Propagator<float>& plan);

}  // namespace holotrace
