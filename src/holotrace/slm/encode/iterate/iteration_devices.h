#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/observer.h"
#include "holotrace/base/process_links.h"
#include "holotrace/data/params/device.h"
#include "holotrace/data/target.h"
#include "holotrace/opencl/device.h"
#include "holotrace/slm/encode/iterate/frame_descent.h"
#include "holotrace/wave/shared/stage_on_device.h"

namespace holotrace {

/// The devices that params.device names for a gradient descent, which share its frames; none: the processor does it.
///
/// Under `auto` it is the device that is expected to be the fastest, by the rates of stage_on_device.h, with as many of its equals
/// as make it faster.
/// @param frames  their number
/// @throws Error  for a device that is not there
std::vector<Device*> devices_for_descent(const std::vector<TargetPlane>& targets, const DescentSetup& setup,
                                         size_t frames);

/// Frames of all processes, and of one of them.
struct SharedCount {
  size_t all = 1, own = 1;
};

/// The device that several processes choose together, as params.device says: under `auto` the processor or one device, whichever
/// is expected to be faster for the frames of one process.
/// @param place   of the process that chooses; all machines are expected to have as many processes
/// @throws Error  for a device that is not there
DeviceChoice common_device(const std::vector<TargetPlane>& targets, const DescentSetup& setup,
                           const SharedCount& frames, const PlaceOnMachine& place);

/// The devices of a process for its frames, those of a machine divided among its processes: of `opencl:N` and its equals one,
/// in turn; of `opencl:all` its part, or one in turn if there are more processes. Processes that share a device have equal parts
/// of its memory from then on. None: the processor.
/// @throws Error  for a device that is not there
std::vector<Device*> devices_of_process(const DeviceChoice& choice, const PlaceOnMachine& place, size_t frames);

/// The one for Gerchberg–Saxton, whose iterations use all planes and move one pattern.
/// @throws Error  for all devices at once, and as above
Device* device_for_projections(const std::vector<TargetPlane>& targets, const DescentSetup& setup);

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
