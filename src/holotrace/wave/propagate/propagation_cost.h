#pragma once

#include <complex>

#include "holotrace/data/summation_rates.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/propagate/propagator.h"

// What a propagation takes, from its plan (plan_propagator).

namespace holotrace {

/// Operations of the processor, without those that make the transfer function.
SummationWork propagation_work(const Propagator<float>& plan);

/// Seconds that the processor is expected to take, by that work and the rates of cost_model.h, with all of its threads.
/// The lines of a large field come from memory, for which those rates do not hold: 1.4 times as long.
double seconds_to_propagate(const Propagator<float>& plan);

inline constexpr double sample_bytes = sizeof(std::complex<float>);  ///< of a field on a device

/// Memory and transfers of a propagation on a device (device_propagator.h) [bytes].
struct DevicePropagationCost {
  double kept = 0;     ///< the transfer function and all other factors, which are sent once and stay on the device
  double work = 0;     ///< memory during a propagation: both fields, and the spectrum in between
  double fields = 0;   ///< samples that are sent and fetched
  double largest = 0;  ///< the largest buffer
  double moved = 0;    ///< what the kernels read and write, if the device's caches hold nothing and every line is held
                       ///< in local memory (line_transform.h)
};

/// Columns of the spectrum that a device computes at once.
int columns_at_once(const Propagator<float>& plan);

/// Work space of the longest lines [bytes], beside their factors; 0 if the device holds all lines in local memory.
double line_work_bytes(const Device& device, const Propagator<float>& plan);

DevicePropagationCost device_propagation_cost(const Device& device, const Propagator<float>& plan);

}  // namespace holotrace
