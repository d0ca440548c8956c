#include <cstdlib>
#include <mutex>

#include "holotrace/base/error.h"
#include "holotrace/opencl/api.h"
#include "holotrace/opencl/program.h"

namespace holotrace {
namespace {

template <class Value>
Value number_from(cl_device_id device, cl_device_info what) {
  Value value{};
  opencl_api().clGetDeviceInfo(device, what, sizeof value, &value, nullptr);
  return value;
}

DeviceType type_of(cl_device_id device) {
  const auto type = number_from<cl_device_type>(device, CL_DEVICE_TYPE);
  if (type & CL_DEVICE_TYPE_GPU) return DeviceType::gpu;
  return type & CL_DEVICE_TYPE_CPU ? DeviceType::cpu : DeviceType::other;
}

DeviceInfo describe_device(cl_platform_id platform, cl_device_id device) {
  const OpenClApi& api = opencl_api();
  DeviceInfo info;
  info.name = text_from(api.clGetDeviceInfo, CL_DEVICE_NAME, device);
  info.platform = text_from(api.clGetPlatformInfo, CL_PLATFORM_NAME, platform) + ", " +
                  text_from(api.clGetPlatformInfo, CL_PLATFORM_VERSION, platform);
  info.driver = text_from(api.clGetDeviceInfo, CL_DRIVER_VERSION, device);
  info.type = type_of(device);
  info.compute_units = int(number_from<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS));
  info.largest_group = number_from<size_t>(device, CL_DEVICE_MAX_WORK_GROUP_SIZE);
  info.memory = double(number_from<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE));
  info.largest_buffer = double(number_from<cl_ulong>(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE));
  info.local_memory = double(number_from<cl_ulong>(device, CL_DEVICE_LOCAL_MEM_SIZE));
  info.has_compiler = number_from<cl_bool>(device, CL_DEVICE_COMPILER_AVAILABLE) == CL_TRUE;
  return info;
}

// The equal parts of a device; the device itself if it cannot be split so.
std::vector<cl_device_id> split(cl_device_id device, int parts) {
  const auto units = cl_device_partition_property(number_from<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS));
  const cl_device_partition_property equally[] = {CL_DEVICE_PARTITION_EQUALLY, units / parts, 0};
  std::vector<cl_device_id> made(static_cast<size_t>(parts));
  if (parts < 2 || units % parts != 0 ||
      opencl_api().clCreateSubDevices(device, equally, cl_uint(parts), made.data(), nullptr) != CL_SUCCESS)
    return {device};
  return made;
}

int wanted_parts() {
  const char* const text = std::getenv("HOLOTRACE_SPLIT_DEVICES");
  if (!text) return 1;
  const int parts = std::atoi(text);
  require(parts >= 1, "expected a number from 1 in HOLOTRACE_SPLIT_DEVICES, got \"{}\"", text);
  return parts;
}

struct Found {
  std::vector<DeviceInfo> infos;
  std::vector<DeviceHandles> handles;
};

Found find_devices() {
  const OpenClApi& api = opencl_api();
  Found found;
  const int parts = wanted_parts();
  cl_uint count = 0;
  // Without drivers, loaders report an error of their own instead of 0 platforms.
  if (api.clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS) return found;
  std::vector<cl_platform_id> platforms(count);
  if (api.clGetPlatformIDs(count, platforms.data(), nullptr) != CL_SUCCESS) return found;
  for (const cl_platform_id platform : platforms) {
    if (api.clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS) continue;
    std::vector<cl_device_id> devices(count);
    if (api.clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, devices.data(), nullptr) != CL_SUCCESS) continue;
    for (const cl_device_id whole : devices)
      for (const cl_device_id device : split(whole, parts)) {
        found.infos.push_back(describe_device(platform, device));
        found.infos.back().number = int(found.handles.size());
        found.handles.push_back({platform, device});
      }
  }
  return found;
}

const Found& found_devices() {
  static const Found found = find_devices();
  return found;
}

}  // namespace

const std::vector<DeviceInfo>& list_devices() { return found_devices().infos; }

DeviceHandles handles_of(int number) { return found_devices().handles.at(size_t(number)); }

}  // namespace holotrace
