#include "holotrace/wave/shared/device_rates.h"

#include <map>
#include <mutex>
#include <utility>

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

}  // namespace holotrace
