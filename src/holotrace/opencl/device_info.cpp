#include <algorithm>

#include "holotrace/base/error.h"
#include "holotrace/opencl/device.h"

namespace holotrace {

const DeviceInfo& require_device(const std::vector<DeviceInfo>& devices, int number) {
  require(!devices.empty(),
          "expected a device for OpenCL, got none: no driver is installed; install that of your card, or PoCL "
          "(pocl-opencl-icd), or use the device cpu");
  require(number >= 0 && size_t(number) < devices.size(),
          "expected the number of a device from 0 to {}, got {}; holotrace info --devices lists them",
          devices.size() - 1, number);
  return devices[size_t(number)];
}

std::vector<int> equal_devices(const std::vector<DeviceInfo>& devices, int number) {
  const DeviceInfo& model = require_device(devices, number);
  std::vector<int> equal;
  for (const DeviceInfo& info : devices)
    if (info.name == model.name && info.platform == model.platform && info.driver == model.driver &&
        info.compute_units == model.compute_units)
      equal.push_back(info.number);
  return equal;
}

int equal_device(const std::vector<DeviceInfo>& devices, int number, int step) {
  if (number < 0 || size_t(number) >= devices.size()) return number;
  const std::vector<int> equal = equal_devices(devices, number);
  const auto at = std::find(equal.begin(), equal.end(), number) - equal.begin();
  return equal[(size_t(at) + size_t(step)) % equal.size()];
}

std::string type_name(DeviceType type) {
  return type == DeviceType::cpu ? "cpu" : type == DeviceType::gpu ? "gpu" : "other";
}

}  // namespace holotrace
