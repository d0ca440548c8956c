#pragma once

#include <string>
#include <vector>

#include "holotrace/data/rates.h"
#include "holotrace/opencl/device.h"

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

/// Times small jobs for each method of summing waves on one thread: the fastest of several runs each. Takes 0.3 s.
std::vector<TimedWork> time_summation();

/// The rates of one thread of this machine: fit_rates of time_summation, rounded (coarse_rate), so that another
/// calibration of the same machine mostly gives the same rates. One thread, whatever number is in use: the choice of a
/// method depends on these rates, and it must not depend on the number of threads.
SummationRates calibrate_summation();

/// A text for the machine that rates are valid for: processor, instruction set, bf16 units, and program version.
/// Rates with another key are not valid here.
std::string calibration_key();

/// Times a sum of waves, a propagation and transfers on a device: the fastest of several runs each, rounded (coarse_rate) as
/// calibrate_summation does. Takes a tenth of a second, and as long as its driver needs to compile the kernels.
DeviceRates calibrate_device(Device& device);

/// A text for the device, driver and program version that rates are valid for.
std::string device_calibration_key(const DeviceInfo& info);

}  // namespace holotrace
