#pragma once

#include <string>
#include <vector>

#include "holotrace/estimate/machine/fit_rates.h"

namespace holotrace {

/// Times small instances of each way to sum waves, on one thread, the fastest of several runs each. Takes some 0.3 s.
std::vector<TimedWork> time_summation();

/// The rates of one thread of this machine: fit_rates of time_summation, made coarse (coarse_rate), so that another
/// calibration of the same machine mostly gives the same. They are of one thread, whatever number is in use, since the
/// choice of a method, which goes by them, may not depend on it.
SummationRates calibrate_summation();

/// What rates hold for, as text: the processor, its instruction set and bf16 units, and the version of the program.
/// Rates that were kept for another are of no use.
std::string calibration_key();

}  // namespace holotrace
