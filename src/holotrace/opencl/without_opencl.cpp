// The room in a build without OpenCL (HOLOTRACE_OPENCL=OFF, or its headers are missing): there are no devices.

#include "holotrace/base/error.h"
#include "holotrace/opencl/device.h"

namespace holotrace {
namespace {

[[noreturn]] void fail_without() {
  fail("expected a build with OpenCL, got one without; build with -DHOLOTRACE_OPENCL=ON, or use the device cpu");
}

}  // namespace

struct Device::State {};

DeviceBuffer::DeviceBuffer(DeviceBuffer&&) noexcept {}
DeviceBuffer& DeviceBuffer::operator=(DeviceBuffer&&) noexcept { return *this; }
DeviceBuffer::~DeviceBuffer() = default;

Device::Device(const DeviceInfo&) { fail_without(); }
Device::Device(const DeviceInfo&, double) { fail_without(); }
Device::~Device() = default;
bool Device::only_counts() const { fail_without(); }
DeviceBuffer Device::make_buffer(size_t, const std::string&) { fail_without(); }
void Device::release(DeviceBuffer&) noexcept {}
void Device::write(const DeviceBuffer&, const void*, size_t) { fail_without(); }
void Device::read(const DeviceBuffer&, void*, size_t) { fail_without(); }
void Device::run(const Kernel&, const WorkSize&, std::initializer_list<KernelArgument>) { fail_without(); }
void Device::finish() { fail_without(); }
DeviceUse Device::use() const { fail_without(); }
double Device::memory() const { fail_without(); }
double Device::memory_left() const { fail_without(); }
double Device::free_memory() const { fail_without(); }
void Device::limit_memory(double) { fail_without(); }
void Device::guard_buffers(bool) { fail_without(); }
void Device::limit_groups(size_t) { fail_without(); }
size_t Device::broken_guards() const { fail_without(); }

Device& open_device(int) { fail_without(); }
std::vector<Device*> open_equal_devices(int, size_t) { fail_without(); }
std::vector<int> open_devices() { return {}; }
const std::vector<DeviceInfo>& list_devices() { fail_without(); }

void set_program_store(ProgramStore) {}
const ProgramStore& program_store() { fail_without(); }

}  // namespace holotrace
