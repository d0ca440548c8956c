#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <type_traits>

#include "holotrace/base/error.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/params/device.h"
#include "holotrace/opencl/device.h"

namespace holotrace {

/// Warns that the processor does what the device `auto` should have done, and why.
inline void warn_of_takeover(const Observer& observer, const std::string& why) {
  observer.warn(fmt::format("the device auto: the processor took over, because {}", why));
}

/// What work(device) returns on the device of a choice: the one that is named, or for `auto` the one that `fastest()` names
/// (fastest_device.h). If that one fails, a warning says why.
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
