#include "holotrace/wave/shared/stage_on_device.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/opencl/device.h"

namespace holotrace {
namespace {

// The rates belong to the machine, as those of cost_model.h do.
struct Rates {
  std::recursive_mutex mutex;  // recursive: a measurement sums waves
  std::function<DeviceRates(Device&)> measure;
  std::map<int, DeviceRates> of_devices;
};

Rates& all_rates() {
  static Rates the_rates;
  return the_rates;
}

}  // namespace

void set_device_rates(std::function<DeviceRates(Device& device)> measure) {
  const std::lock_guard lock(all_rates().mutex);
  all_rates().measure = std::move(measure);
  all_rates().of_devices.clear();
}

DeviceRates device_rates(Device& device) {
  Rates& rates = all_rates();
  const std::lock_guard lock(rates.mutex);
  const int number = device.info().number;
  const auto known = rates.of_devices.find(number);
  if (known != rates.of_devices.end()) return known->second;
  const DeviceRates measured = rates.measure ? rates.measure(device) : DeviceRates();
  return rates.of_devices[number] = measured;
}

namespace {

std::vector<DeviceInfo> devices_here() {
  try {
    return list_devices();
  } catch (const Error&) {
    return {};  // no OpenCL here
  }
}

}  // namespace

double predict_seconds(const DeviceUse& use, const DeviceRates& rates) {
  constexpr double seconds_to_wait = 3e-4;  // for a transfer and the kernels before it, on slow drivers
  // Nothing takes no time, also at rates that were not measured.
  const auto seconds = [](size_t bytes, double rate) { return bytes > 0 ? double(bytes) / rate : 0; };
  return seconds(use.bytes_moved, rates.moved_bytes) + seconds(use.bytes_in + use.bytes_out, rates.bytes) +
         double(use.transfers) * seconds_to_wait;
}

Device* fastest_device(double on_processor, const std::function<double(Device& device)>& on_device) {
  double least = on_processor;
  Device* fastest = nullptr;
  const auto consider = [&](int number, double opening) {
    if (opening >= least) return;
    try {
      Device& device = open_device(number);
      const double here = opening + on_device(device);
      if (here >= least) return;
      least = here;
      fastest = &device;
    } catch (const Error&) {
      // A device that does not work is not chosen.
    }
  };
  const std::vector<int> opened = open_devices();
  for (const int number : opened) consider(number, 0);
  if (least <= seconds_to_open_device) return fastest;  // drivers need not be loaded
  for (const DeviceInfo& info : devices_here())
    if (std::find(opened.begin(), opened.end(), info.number) == opened.end())
      consider(info.number, seconds_to_open_device);
  return fastest;
}

namespace {

struct AllKept {
  std::mutex mutex;
  std::vector<KeptOnDevices> all;
};

// Never destroyed: threads may use devices until the program ends.
AllKept& all_kept() {
  static auto& made = *new AllKept;
  return made;
}

// A copy: what is kept has locks of its own.
std::vector<KeptOnDevices> kept_by_all() {
  const std::lock_guard lock(all_kept().mutex);
  return all_kept().all;
}

}  // namespace

void keep_until_room_is_short(KeptOnDevices kept) {
  const std::lock_guard lock(all_kept().mutex);
  all_kept().all.push_back(std::move(kept));
}

void make_room(Device& device, double bytes) {
  const auto lock = device.lock();
  if (device.memory_left() >= bytes) return;
  for (const KeptOnDevices& kept : kept_by_all()) kept.drop(device);
}

double possible_room(const Device& device) {
  double bytes = device.memory_left();
  for (const KeptOnDevices& kept : kept_by_all()) bytes += kept.bytes(device);
  return bytes;
}

}  // namespace holotrace
