#pragma once

#include "holotrace/opencl/api.h"
#include "holotrace/opencl/device.h"

// Only files of this room include this header.

namespace holotrace {

struct DeviceHandles {
  cl_platform_id platform;
  cl_device_id device;
};

/// Those of a device of list_devices.
DeviceHandles handles_of(int number);

}  // namespace holotrace
