#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/params/device.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/shared/on_chosen_device.h"

namespace holotrace {

/// Facts: `device`, the name that the devices have; `devices`, their number if there are several.
inline void tell_devices(const std::vector<Device*>& devices, const Observer& observer) {
  if (!devices.empty()) observer.fact("device", devices.front()->info().name);
  if (devices.size() > 1) observer.fact("devices", int64_t(devices.size()));
}

/// A device that failed during iterations that the processor can do, too.
struct DeviceFault {
  std::string why;
};

/// Where iterations compute: on one or several equal devices or, without one, on the processor.
struct IterationDevices {
  std::vector<Device*> devices{};
  Device* device() const { return devices.empty() ? nullptr : devices.front(); }  ///< the first one
  bool may_change = false;  ///< whether the processor does it if the device fails

  /// Does a part of it that uses the device.
  template <class Work>
  auto compute(const Work& work) const {
    if (!may_change) return work();
    try {
      return work();
    } catch (const Error& error) {
      throw DeviceFault{error.what()};
    }
  }
};

/// What iterate(place) gives. If the device `auto` fails, the processor does it, with a warning.
/// @param devices  those that were chosen; none: the processor
template <class Iterate>
auto on_devices_or_processor(const std::vector<Device*>& devices, const DeviceChoice& choice, const Observer& observer,
                             const Iterate& iterate) {
  try {
    return iterate(IterationDevices{devices, !devices.empty() && choice.kind == DeviceKind::automatic});
  } catch (const DeviceFault& fault) {
    warn_of_takeover(observer, fault.why);
    return iterate(IterationDevices{});
  }
}

}  // namespace holotrace
