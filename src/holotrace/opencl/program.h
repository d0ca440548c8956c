#pragma once

#include <map>
#include <string>

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

/// The kernels of one device, each compiled when it is first asked for. Compiled programs are kept between runs of the
/// program by set_program_store (device.h).
class Programs {
 public:
  Programs(const DeviceInfo& info, cl_device_id device, cl_context context);
  ~Programs();
  Programs(const Programs&) = delete;

  /// @throws Error  if the device's driver refuses it, with the first of its messages
  cl_kernel find(const Kernel& kernel);

 private:
  cl_program compile(const Kernel& kernel, const std::string& source);
  cl_program load(const std::string& key, const std::string& options);

  const DeviceInfo& info_;
  cl_device_id device_;
  cl_context context_;
  std::map<std::string, cl_program> programs_;  // by options and source
  std::map<std::string, cl_kernel> kernels_;    // by name, options and source
};

}  // namespace holotrace
