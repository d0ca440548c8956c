#include "holotrace/opencl/device_info.h"

namespace holotrace {

int equal_device(const std::vector<DeviceInfo>& devices, int number, int step) {
  if (number < 0 || size_t(number) >= devices.size()) return number;
  const DeviceInfo& model = devices[size_t(number)];
  std::vector<int> equal;
  size_t at = 0;
  for (const DeviceInfo& info : devices) {
    if (info.name != model.name || info.platform != model.platform || info.driver != model.driver) continue;
    if (info.number == number) at = equal.size();
    equal.push_back(info.number);
  }
  return equal[(at + size_t(step)) % equal.size()];
}

std::string type_name(DeviceType type) {
  return type == DeviceType::cpu ? "cpu" : type == DeviceType::gpu ? "gpu" : "other";
}

}  // namespace holotrace
