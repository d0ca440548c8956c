#pragma once

#include <fmt/format.h>

#include <functional>
#include <optional>
#include <string>
#include <type_traits>

#include "holotrace/base/error.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/params/device.h"
#include "holotrace/data/rates.h"
#include "holotrace/opencl/device.h"

namespace holotrace {

/// Sets the source of the rates of devices. `measure` is called once for each device, when a method is first chosen. It
/// should give the same rates on every run, as that of set_summation_rates should. Without it all rates are 0, and
/// `auto` never chooses a device.
void set_device_rates(std::function<DeviceRates(Device& device)> measure);

/// The rates of a device; kept while the program runs.
DeviceRates device_rates(Device& device);

inline constexpr double seconds_to_open_device = 0.3;

/// Seconds that a device is expected to take for what was counted: what kernels read and write, what is transferred, and waiting
/// for each transfer.
double predict_seconds(const DeviceUse& use, const DeviceRates& rates);

/// The device that is expected to do some work in the least time; none: the processor does.
///
/// A device that is not open yet counts 0.3 s more, which opening takes. Devices that do not work, or throw an Error, are
/// not chosen.
/// @param on_processor  seconds that the processor is expected to take
/// @param on_device     seconds that a device is expected to take; infinite if that is not known
Device* fastest_device(double on_processor, const std::function<double(Device& device)>& on_device);

/// What a stage keeps on devices for later, until others need its memory.
struct KeptOnDevices {
  std::function<double(const Device& device)> bytes;  ///< its memory there
  std::function<void(const Device& device)> drop;     ///< called under the device's lock
};

/// From here on, make_room drops this, too.
void keep_until_room_is_short(KeptOnDevices kept);

/// Makes room on a device: if fewer bytes of its memory are left, all that is kept there for later is dropped. A caller
/// whose room no other thread may take holds the device's lock until it has its memory.
void make_room(Device& device, double bytes);

/// Memory that is left on a device, or is once all that is kept there for later is dropped [bytes].
double possible_room(const Device& device);

/// Warns that the processor does what the device `auto` should have done, and why.
inline void warn_of_takeover(const Observer& observer, const std::string& why) {
  observer.warn(fmt::format("the device auto: the processor took over, because {}", why));
}

/// What work(device) returns on the device of a choice: the one that is named, or for `auto` the one that `fastest()` names.
/// If that one fails, a warning says why.
///
/// Fact: `device`, its name.
/// @return        nothing if the processor should do it
/// @throws Error  for all devices at once, for a named device that is not there or fails, and as `fastest` does
template <class Fastest, class Work>
auto on_chosen_device(const DeviceChoice& choice, const Observer& observer, const Fastest& fastest, const Work& work)
    -> std::optional<std::invoke_result_t<const Work&, Device&>> {
  const auto told = [&](Device& device) {
    auto result = work(device);
    observer.fact("device", device.info().name);
    return result;
  };
  require_one_device(choice);
  if (choice.kind == DeviceKind::cpu) return std::nullopt;
  if (choice.kind == DeviceKind::opencl) return told(open_device(choice.number));
  Device* const device = fastest();
  if (!device) return std::nullopt;
  try {
    return told(*device);
  } catch (const Error& error) {
    warn_of_takeover(observer, error.what());
    return std::nullopt;
  }
}

}  // namespace holotrace
