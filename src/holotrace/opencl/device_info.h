#pragma once

#include <string>
#include <vector>

namespace holotrace {

enum class DeviceType { cpu, gpu, other };

/// A device that a driver for OpenCL offers.
struct DeviceInfo {
  int number = 0;        ///< N of "opencl:N": its place in list_devices
  std::string name;      ///< such as "NVIDIA H100 80GB HBM3"
  std::string platform;  ///< the driver's maker and version, such as "Portable Computing Language, OpenCL 3.0 PoCL 3.1"
  std::string driver;    ///< version of the driver
  DeviceType type = DeviceType::other;
  int compute_units = 0;
  size_t largest_group = 0;   ///< work items of a group
  double memory = 0;          ///< [bytes]
  double largest_buffer = 0;  ///< [bytes]
  double local_memory = 0;    ///< of a group [bytes]
  bool has_compiler = true;   ///< whether it compiles kernels
};

/// All devices of this machine: those of the first platform, then of the second, and so on. Empty without drivers. With
/// HOLOTRACE_SPLIT_DEVICES=N in the environment, which is for tests, devices that can be are split into N equal ones.
/// Cost: the first call loads the drivers, up to a second; other calls do nothing.
/// @throws Error  if this build or this machine has no OpenCL
const std::vector<DeviceInfo>& list_devices();

/// The device with that number.
/// @throws Error  unless there is one
const DeviceInfo& require_device(const std::vector<DeviceInfo>& devices, int number);

/// The numbers of the devices with the name, platform, driver and compute units of device `number`, itself among them.
/// @throws Error  as require_device does
std::vector<int> equal_devices(const std::vector<DeviceInfo>& devices, int number);

/// The number of the device that is `step` places further in the circle of the equal_devices of device `number`:
/// processes that share a machine take one each. The same kernels give the same bytes on all of them.
int equal_device(const std::vector<DeviceInfo>& devices, int number, int step);

/// "cpu", "gpu" or "other".
std::string type_name(DeviceType type);

}  // namespace holotrace
