#include "holotrace/wave/shared/fastest_device.h"

#include <algorithm>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/opencl/device.h"

namespace holotrace {
namespace {

std::vector<DeviceInfo> devices_here() {
  try {
    return list_devices();
  } catch (const Error&) {
    return {};  // no OpenCL here
  }
}

}  // namespace

Device* fastest_device(double on_processor, const std::function<double(Device& device)>& on_device) {
  double least = on_processor;
  Device* fastest = nullptr;
  const auto consider = [&](int number, double opening) {
    if (opening >= least) return;
    try {
      Device& device = open_device(number);
      const double here = opening + on_device(device);
      if (here >= least) return;
      least = here;
      fastest = &device;
    } catch (const Error&) {
      // A device that does not work is not chosen.
    }
  };
  const std::vector<int> opened = open_devices();
  for (const int number : opened) consider(number, 0);
  if (least <= seconds_to_open_device) return fastest;  // drivers need not be loaded
  for (const DeviceInfo& info : devices_here())
    if (std::find(opened.begin(), opened.end(), info.number) == opened.end())
      consider(info.number, seconds_to_open_device);
  return fastest;
}

}  // namespace holotrace
