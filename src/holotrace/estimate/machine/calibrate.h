#pragma once

#include <string>
#include <vector>

#include "holotrace/estimate/machine/fit_rates.h"

namespace holotrace {

/// Times small jobs for each method of summing waves on one thread: the fastest of several runs each. Takes 0.3 s.
std::vector<TimedWork> time_summation();

/// The rates of one thread of this machine: fit_rates of time_summation, rounded (coarse_rate), so that another
/// calibration of the same machine mostly gives the same rates. One thread, whatever number is in use: the choice of a
/// method depends on these rates, and it must not depend on the number of threads.
SummationRates calibrate_summation();

/// A text for the machine that rates are valid for: processor, instruction set, bf16 units, and program version.
/// Rates with another key are not valid here.
std::string calibration_key();

}  // namespace holotrace
