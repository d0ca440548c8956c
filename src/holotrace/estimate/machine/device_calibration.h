#pragma once

#include <string>

#include "holotrace/data/device_rates.h"
#include "holotrace/opencl/device.h"

namespace holotrace {

/// Times a sum of waves, a propagation and transfers on a device: the fastest of several runs each, rounded (coarse_rate) as
/// calibrate_summation does. Takes a tenth of a second, and as long as its driver needs to compile the kernels.
DeviceRates calibrate_device(Device& device);

/// A text for the device, driver and program version that rates are valid for.
std::string device_calibration_key(const DeviceInfo& info);

}  // namespace holotrace
