#pragma once

#include <string>

namespace holotrace {

/// Where a stage computes: on the processor; on an OpenCL device; where it is expected to be faster; or on all OpenCL devices
/// at once of the same model as the first one.
enum class DeviceKind { cpu, opencl, automatic, all };

/// "cpu", "auto", "opencl" for the first device, "opencl:N" for device N of `holotrace info --devices`, "opencl:all".
struct DeviceChoice {
  DeviceKind kind = DeviceKind::cpu;
  int number = 0;  ///< of an OpenCL device, from 0
  bool operator==(const DeviceChoice&) const = default;
};

/// Whether a stage with these parameters can run on all devices at once.
template <class Params>
inline constexpr bool runs_on_all_devices = false;

/// @throws Error  for all devices at once. @param about  " for KEY", or nothing
void require_one_device(const DeviceChoice& choice, const std::string& about = "");

/// @throws Error  for another text
DeviceChoice parse_device(const std::string& text);

std::string device_text(const DeviceChoice& choice);

/// The help text of a choice. @param work  what the device does  @param all  what opencl:all stands for, or nothing
std::string device_help(const std::string& work, const std::string& all = "");

}  // namespace holotrace
