#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
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

class Device;

/// Memory on a device; it is released with this object, which may be done by any thread. It must not outlive its device.
class DeviceBuffer {
 public:
  DeviceBuffer() = default;
  DeviceBuffer(DeviceBuffer&& other) noexcept;
  DeviceBuffer& operator=(DeviceBuffer&& other) noexcept;
  DeviceBuffer(const DeviceBuffer&) = delete;
  DeviceBuffer& operator=(const DeviceBuffer&) = delete;
  ~DeviceBuffer();

  size_t bytes() const { return bytes_; }

 private:
  friend class Device;
  friend class KernelArgument;
  Device* device_ = nullptr;
  void *memory_ = nullptr, *whole_ = nullptr;  // whole: with the guards, if there are any
  size_t bytes_ = 0;
};

/// A kernel: a function `name` in the OpenCL C of `sources`, which are compiled together with these options.
struct Kernel {
  const char* name;
  std::vector<const char*> sources;
  std::string options{};  ///< such as "-D BATCH=16"
};

/// The most groups along y or z that are started at once: NVIDIA's cards take no more (CUDA C++ Programming Guide, technical
/// specifications: 65,535 blocks of a grid along y and z).
inline constexpr size_t most_groups_across = 65535;

/// Groups of work items: how many of them, and the size of each. More than `most_groups_across` along y or z are started in
/// parts. So along y and z a kernel finds its place by get_global_id, which counts on, and not by get_group_id, which begins
/// again.
struct WorkSize {
  size_t groups_x = 1, groups_y = 1;
  size_t group_x = 1, group_y = 1;
  size_t groups_z = 1;  ///< of one item along z
};

/// An argument of a kernel: a buffer, or a plain value, which must have the same layout on the device. For use within
/// the call of Device::run only.
class KernelArgument {
 public:
  KernelArgument(const DeviceBuffer& buffer)
      : value_(&buffer.memory_), bytes_(sizeof buffer.memory_), moved_(buffer.bytes()) {}
  template <class Value>
  requires std::is_trivially_copyable_v<Value> KernelArgument(const Value& value)
      : value_(&value), bytes_(sizeof value) {}

  /// A buffer of which the kernel reads and writes other than all of its bytes once.
  static KernelArgument moving(const DeviceBuffer& buffer, size_t bytes) {
    KernelArgument argument(buffer);
    argument.moved_ = bytes;
    return argument;
  }
  /// A buffer in place of one that there is not; the kernel does not use it.
  static KernelArgument unused(const DeviceBuffer& buffer) { return moving(buffer, 0); }
  /// A buffer whose values the kernel reads and writes.
  static KernelArgument changed(const DeviceBuffer& buffer) { return moving(buffer, 2 * buffer.bytes()); }

  const void* value() const { return value_; }
  size_t bytes() const { return bytes_; }
  /// What the kernel reads and writes of it [bytes].
  size_t moved() const { return moved_; }

 private:
  const void* value_;
  size_t bytes_, moved_ = 0;
};

/// What a device has done for this program.
struct DeviceUse {
  size_t bytes_held = 0;      ///< memory of its buffers
  size_t most_held = 0;       ///< the most of it so far
  size_t largest_buffer = 0;  ///< bytes of the largest one so far
  size_t buffers = 0;         ///< number of its buffers
  size_t bytes_in = 0;        ///< sent to it
  size_t bytes_out = 0;       ///< fetched from it
  size_t transfers = 0;       ///< number of both
  size_t kernels = 0;         ///< calls of kernels
  size_t bytes_moved = 0;     ///< read and written by kernels (KernelArgument), if caches hold nothing

  /// Memory that was needed at most beside what is held now.
  size_t most_released() const { return most_held - bytes_held; }
};

/// A device with one queue: what it is asked to do is done in this order. One thread may use it at a time; it holds
/// lock() meanwhile.
///
/// Errors are sentences that name the device: a kernel that its driver refuses (with the first lines of the compiler's
/// messages), memory that is used up, a device that stops.
class Device {
 public:
  /// For open_device.
  explicit Device(const DeviceInfo& info);
  /// A device of the same kind that only counts: an algorithm that is run on it forecasts its `use` of a real one with that
  /// memory [bytes]. Buffers have a size but no content, kernels are not run, and what is read stays as it was. It never refuses
  /// memory, so memory_left() may be negative.
  Device(const DeviceInfo& info, double free_memory);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const { return info_; }
  std::unique_lock<std::recursive_mutex> lock() { return std::unique_lock(mutex_); }

  /// Memory with undefined content. @param what  what it is for, such as "the waves"
  DeviceBuffer make_buffer(size_t bytes, const std::string& what);
  /// Memory with a copy of `values`.
  template <class Value, class Allocator>
  DeviceBuffer upload(const std::vector<Value, Allocator>& values, const std::string& what) {
    static_assert(std::is_trivially_copyable_v<Value>);
    DeviceBuffer buffer = make_buffer(values.size() * sizeof(Value), what);
    write(buffer, values.data(), buffer.bytes());
    return buffer;
  }
  /// Memory with `count` values that fill(Value* to) writes. A device that only counts does not call it.
  template <class Value, class Fill>
  DeviceBuffer upload(size_t count, const std::string& what, const Fill& fill) {
    std::vector<Value> values(only_counts() ? 0 : count);
    if (!values.empty()) fill(values.data());
    DeviceBuffer buffer = make_buffer(count * sizeof(Value), what);
    write(buffer, values.data(), buffer.bytes());
    return buffer;
  }
  void write(const DeviceBuffer& to, const void* from, size_t bytes);
  void read(const DeviceBuffer& from, void* to, size_t bytes);
  /// The values of a buffer; ones from a device that only counts.
  template <class Value>
  std::vector<Value> fetch(const DeviceBuffer& from) {
    std::vector<Value> values(from.bytes() / sizeof(Value), Value(1));
    read(from, values.data(), from.bytes());
    return values;
  }

  /// Starts a kernel, which is compiled when it is first called.
  void run(const Kernel& kernel, const WorkSize& size, std::initializer_list<KernelArgument> arguments);
  /// Waits for all kernels.
  void finish();

  DeviceUse use() const;
  /// Memory that buffers may have in all [bytes]: 80 % of the device's.
  double memory() const;
  /// Memory of it that is still free [bytes].
  double memory_left() const;
  /// What one buffer can have of it [bytes].
  double free_memory() const;

  /// Memory that the device is said to have [bytes], if others use it as well, or for tests; 0: its own.
  void limit_memory(double bytes);
  /// For tests: buffers made from now on have guards on both sides, which are checked when they are released.
  void guard_buffers(bool has_guards);
  /// For tests: the most groups along y or z that are started at once; 0: `most_groups_across`.
  void limit_groups(size_t most);
  /// For tests: number of guards that kernels have overwritten.
  size_t broken_guards() const;

 private:
  friend class DeviceBuffer;
  bool only_counts() const;
  void count(size_t bytes, DeviceBuffer& buffer);
  void release(DeviceBuffer& buffer) noexcept;

  struct State;
  DeviceInfo info_;
  std::recursive_mutex mutex_;
  std::unique_ptr<State> state_;
};

/// The device with that number, opened when it is first asked for and kept while the program runs.
/// @throws Error  if this build or this machine has no OpenCL, or no such device
Device& open_device(int number);

/// The devices that are equal to that one (equal_devices), itself first.
/// @param most    their largest number
/// @throws Error  as open_device does
std::vector<Device*> open_equal_devices(int number, size_t most = SIZE_MAX);

/// The numbers of the devices that are open.
std::vector<int> open_devices();

/// How compiled kernels are kept between runs, and where the messages of a compiler that refuses one go. Empty
/// functions keep nothing.
struct ProgramStore {
  std::function<std::optional<std::string>(const std::string& key)> load;  ///< what `save` got for that key
  std::function<void(const std::string& key, const std::string& binary)> save;
  std::function<std::string(const std::string& log)> save_log;  ///< returns the path of the file, "" for none
};

/// Sets the store of this program. A key names the device, its driver, the options and the source.
void set_program_store(ProgramStore store);

/// The store that was set.
const ProgramStore& program_store();

}  // namespace holotrace
