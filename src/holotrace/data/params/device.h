#pragma once

#include <string>

namespace holotrace {

/// Where a stage computes: on the processor; on an OpenCL device; or where it is expected to be faster.
enum class DeviceKind { cpu, opencl, automatic };

/// "cpu", "auto", "opencl" for the first device, "opencl:N" for device N of `holotrace info --devices`.
struct DeviceChoice {
  DeviceKind kind = DeviceKind::cpu;
  int number = 0;  ///< of an OpenCL device, from 0
  bool operator==(const DeviceChoice&) const = default;
};

/// @throws Error  for another text
DeviceChoice parse_device(const std::string& text);

std::string device_text(const DeviceChoice& choice);

}  // namespace holotrace
