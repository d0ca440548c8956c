#pragma once

#include <functional>

#include "holotrace/data/device_rates.h"
#include "holotrace/opencl/device.h"

namespace holotrace {

/// Sets the source of the rates of devices. `measure` is called once for each device, when a method is first chosen. It
/// should give the same rates on every run, as that of set_summation_rates should. Without it all rates are 0, and
/// `auto` never chooses a device.
void set_device_rates(std::function<DeviceRates(Device& device)> measure);

/// The rates of a device; kept while the program runs.
DeviceRates device_rates(Device& device);

}  // namespace holotrace
