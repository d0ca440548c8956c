#pragma once

#include <string>

#include "holotrace/base/error.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/params/device.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/shared/on_chosen_device.h"

namespace holotrace {

/// A device that failed during iterations that the processor can do, too.
struct DeviceFault {
  std::string why;
};

/// Where iterations compute: on a device or, without one, on the processor.
struct IterationPlace {
  Device* device = nullptr;
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
/// @param device  the one that was chosen; none: the processor
template <class Iterate>
auto on_device_or_processor(Device* device, const DeviceChoice& choice, const Observer& observer,
                            const Iterate& iterate) {
  try {
    return iterate(IterationPlace{device, device && choice.kind == DeviceKind::automatic});
  } catch (const DeviceFault& fault) {
    warn_of_takeover(observer, fault.why);
    return iterate(IterationPlace{});
  }
}

}  // namespace holotrace
