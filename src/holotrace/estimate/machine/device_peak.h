#pragma once

#include "holotrace/opencl/device.h"

namespace holotrace {

/// The highest rates of a device, each the best of several measurements.
struct DevicePeak {
  double multiply_adds = 0;  ///< of floats in registers [1/s]
  double memory = 0;         ///< bytes read and written by a copy of 32 MB [1/s]
};

DevicePeak measure_device_peak(Device& device);

}  // namespace holotrace
