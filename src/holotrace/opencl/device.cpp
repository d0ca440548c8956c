#include "holotrace/opencl/device.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <map>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/opencl/program.h"

namespace holotrace {
namespace {

constexpr double usable = 0.8;         // of the device's memory: its driver and its screen need some
constexpr size_t guard_bytes = 4096;   // a multiple of every device's alignment of buffers, at most 1024 bits
constexpr unsigned char guard = 0xA5;  // a pattern that is no sensible float

using Guard = std::array<unsigned char, guard_bytes>;

cl_mem memory_of(void* handle) { return static_cast<cl_mem>(handle); }

[[noreturn]] void fail_as_lost(const DeviceInfo& info, const char* during, cl_int status) {
  fail(
      "the device {} stopped during {}: {}; it may have been reset or be out of memory; run again, or use the device "
      "cpu",
      info.name, during, status_name(status));
}

}  // namespace

struct Device::State {
  DeviceHandles handles{};
  cl_context context = nullptr;
  cl_command_queue queue = nullptr;
  std::unique_ptr<Programs> programs;
  bool only_counts = false;
  DeviceUse use;                       // but for bytes_held
  std::atomic<size_t> bytes_held = 0;  // forecasts read it while others use the device
  std::atomic<double> memory = 0;      // that the device is said to have; forecasts read it, too
  bool has_guards = false;
  size_t most_groups = most_groups_across;
  size_t broken_guards = 0;

  ~State() {
    programs.reset();
    if (queue) opencl_api().clReleaseCommandQueue(queue);
    if (context) opencl_api().clReleaseContext(context);
  }
};

DeviceBuffer::DeviceBuffer(DeviceBuffer&& other) noexcept { *this = std::move(other); }

DeviceBuffer& DeviceBuffer::operator=(DeviceBuffer&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(memory_, other.memory_);
  std::swap(whole_, other.whole_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

DeviceBuffer::~DeviceBuffer() {
  if (device_) device_->release(*this);
}

Device::Device(const DeviceInfo& info) : info_(info), state_(std::make_unique<State>()) {
  const OpenClApi& api = opencl_api();
  State& s = *state_;
  s.handles = handles_of(info.number);
  s.memory = info.memory;
  require(info.has_compiler, "expected a device whose driver compiles kernels, got {}; use another, or the device cpu",
          info.name);
  const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM,
                                              reinterpret_cast<cl_context_properties>(s.handles.platform), 0};
  cl_int status = CL_SUCCESS;
  s.context = api.clCreateContext(properties, 1, &s.handles.device, nullptr, nullptr, &status);
  if (status == CL_SUCCESS) s.queue = api.clCreateCommandQueue(s.context, s.handles.device, 0, &status);
  require(status == CL_SUCCESS,
          "expected the device {} to be ready, got {}; is another program using it, or does its driver match it?",
          info.name, status_name(status));
  s.programs = std::make_unique<Programs>(info_, s.handles.device, s.context);
}

Device::Device(const DeviceInfo& info, double free_memory) : info_(info), state_(std::make_unique<State>()) {
  state_->only_counts = true;
  state_->memory = free_memory / usable;
}

Device::~Device() = default;

bool Device::only_counts() const { return state_->only_counts; }

void Device::count(size_t bytes, DeviceBuffer& buffer) {
  State& s = *state_;
  buffer.bytes_ = bytes;
  s.bytes_held += bytes;
  s.use.most_held = std::max(s.use.most_held, s.bytes_held.load());
  s.use.largest_buffer = std::max(s.use.largest_buffer, bytes);
  ++s.use.buffers;
}

DeviceBuffer Device::make_buffer(size_t bytes, const std::string& what) {
  const OpenClApi& api = opencl_api();
  State& s = *state_;
  const auto fail_for_memory = [&](const std::string& got) {
    fail("expected {} of memory for {} on the device {}, got {}; use a smaller panel or fewer waves, or the device cpu",
         format_bytes(double(bytes)), what, info_.name, got);
  };
  DeviceBuffer buffer;
  if (s.only_counts) {
    buffer.device_ = this;
    count(bytes, buffer);
    return buffer;
  }
  if (double(bytes) > free_memory()) fail_for_memory(format_bytes(std::max(0.0, free_memory())) + " that are free");
  const size_t edge = s.has_guards ? guard_bytes : 0, size = std::max<size_t>(bytes, 1);
  cl_int status = CL_SUCCESS;
  buffer.whole_ = api.clCreateBuffer(s.context, CL_MEM_READ_WRITE, size + 2 * edge, nullptr, &status);
  if (status != CL_SUCCESS) fail_for_memory(status_name(status));
  buffer.memory_ = buffer.whole_;
  buffer.device_ = this;  // from here on it is released on every way out
  count(bytes, buffer);
  if (edge == 0) return buffer;
  const cl_buffer_region region{edge, size};
  buffer.memory_ = api.clCreateSubBuffer(memory_of(buffer.whole_), CL_MEM_READ_WRITE, CL_BUFFER_CREATE_TYPE_REGION,
                                         &region, &status);
  if (status != CL_SUCCESS) {
    buffer.memory_ = buffer.whole_;
    fail_for_memory(status_name(status));
  }
  Guard pattern;
  pattern.fill(guard);
  for (const size_t at : {size_t(0), edge + size})
    if (status == CL_SUCCESS)
      status = api.clEnqueueWriteBuffer(s.queue, memory_of(buffer.whole_), CL_TRUE, at, edge, pattern.data(), 0,
                                        nullptr, nullptr);
  if (status != CL_SUCCESS) fail_as_lost(info_, "the writing of guards", status);
  return buffer;
}

void Device::release(DeviceBuffer& buffer) noexcept {
  const std::lock_guard lock(mutex_);
  const OpenClApi& api = opencl_api();
  State& s = *state_;
  if (buffer.memory_ != buffer.whole_) {
    Guard found;
    for (const size_t at : {size_t(0), guard_bytes + std::max<size_t>(buffer.bytes_, 1)}) {
      api.clEnqueueReadBuffer(s.queue, memory_of(buffer.whole_), CL_TRUE, at, guard_bytes, found.data(), 0, nullptr,
                              nullptr);
      s.broken_guards += std::any_of(found.begin(), found.end(), [](unsigned char c) { return c != guard; });
    }
    api.clReleaseMemObject(memory_of(buffer.memory_));
  }
  if (buffer.whole_) api.clReleaseMemObject(memory_of(buffer.whole_));
  s.bytes_held -= buffer.bytes_;
  --s.use.buffers;
  buffer.device_ = nullptr;
}

void Device::write(const DeviceBuffer& to, const void* from, size_t bytes) {
  if (bytes == 0) return;
  State& s = *state_;
  require(bytes <= to.bytes_, "expected at most {} bytes for a buffer, got {}; please report it", to.bytes_, bytes);
  s.use.bytes_in += bytes;
  ++s.use.transfers;
  if (s.only_counts) return;
  const cl_int status =
      opencl_api().clEnqueueWriteBuffer(s.queue, memory_of(to.memory_), CL_TRUE, 0, bytes, from, 0, nullptr, nullptr);
  if (status != CL_SUCCESS) fail_as_lost(info_, "a transfer", status);
}

void Device::read(const DeviceBuffer& from, void* to, size_t bytes) {
  if (bytes == 0) return;
  State& s = *state_;
  require(bytes <= from.bytes_, "expected at most {} bytes of a buffer, got {}; please report it", from.bytes_, bytes);
  s.use.bytes_out += bytes;
  ++s.use.transfers;
  if (s.only_counts) return;
  const cl_int status =
      opencl_api().clEnqueueReadBuffer(s.queue, memory_of(from.memory_), CL_TRUE, 0, bytes, to, 0, nullptr, nullptr);
  if (status != CL_SUCCESS) fail_as_lost(info_, "a transfer", status);
}

void Device::run(const Kernel& kernel, const WorkSize& size, std::initializer_list<KernelArgument> arguments) {
  State& s = *state_;
  ++s.use.kernels;
  for (const KernelArgument& argument : arguments) s.use.bytes_moved += argument.moved();
  if (s.only_counts) return;
  const OpenClApi& api = opencl_api();
  const cl_kernel compiled = s.programs->find(kernel);
  cl_uint index = 0;
  for (const KernelArgument& argument : arguments) {
    const cl_int status = api.clSetKernelArg(compiled, index, argument.bytes(), argument.value());
    require(status == CL_SUCCESS, "expected argument {} of the kernel {} to fit, got {}; please report it", index,
            kernel.name, status_name(status));
    ++index;
  }
  const size_t group[3] = {size.group_x, size.group_y, 1};
  const size_t most = s.most_groups;
  for (size_t z = 0; z < size.groups_z; z += most)
    for (size_t y = 0; y < size.groups_y; y += most) {
      const size_t start[3] = {0, y * size.group_y, z};
      const size_t all[3] = {size.groups_x * size.group_x, std::min(size.groups_y - y, most) * size.group_y,
                             std::min(size.groups_z - z, most)};
      const cl_int status = api.clEnqueueNDRangeKernel(s.queue, compiled, 3, start, all, group, 0, nullptr, nullptr);
      if (status != CL_SUCCESS) fail_as_lost(info_, kernel.name, status);
    }
}

void Device::finish() {
  if (state_->only_counts) return;
  const cl_int status = opencl_api().clFinish(state_->queue);
  if (status != CL_SUCCESS) fail_as_lost(info_, "its kernels", status);
}

DeviceUse Device::use() const {
  DeviceUse use = state_->use;
  use.bytes_held = state_->bytes_held;
  return use;
}

double Device::memory() const { return usable * state_->memory; }

double Device::memory_left() const { return memory() - double(state_->bytes_held); }

double Device::free_memory() const { return std::min(memory_left(), info_.largest_buffer); }

void Device::limit_memory(double bytes) { state_->memory = bytes > 0 ? bytes : info_.memory; }

void Device::guard_buffers(bool has_guards) { state_->has_guards = has_guards; }

void Device::limit_groups(size_t most) { state_->most_groups = most > 0 ? most : most_groups_across; }

size_t Device::broken_guards() const { return state_->broken_guards; }

namespace {

// Never destroyed: at the end of the program, drivers may have shut down before.
struct OpenDevices {
  std::mutex mutex;
  std::map<int, std::unique_ptr<Device>> by_number;
};

OpenDevices& all_open() {
  static auto& opened = *new OpenDevices;
  return opened;
}

}  // namespace

Device& open_device(int number) {
  const DeviceInfo& info = require_device(list_devices(), number);
  const std::lock_guard lock(all_open().mutex);
  std::unique_ptr<Device>& device = all_open().by_number[number];
  if (!device) device = std::make_unique<Device>(info);
  return *device;
}

std::vector<Device*> open_equal_devices(int number, size_t most) {
  std::vector<int> numbers = equal_devices(list_devices(), number);
  std::rotate(numbers.begin(), std::find(numbers.begin(), numbers.end(), number), numbers.end());
  numbers.resize(std::min(numbers.size(), most));
  std::vector<Device*> devices;
  for (const int equal : numbers) devices.push_back(&open_device(equal));
  return devices;
}

std::vector<int> open_devices() {
  const std::lock_guard lock(all_open().mutex);
  std::vector<int> numbers;
  for (const auto& [number, device] : all_open().by_number)
    if (device) numbers.push_back(number);
  return numbers;
}

}  // namespace holotrace
