#pragma once

#include <cstddef>
#include <vector>

#include "holotrace/base/process_links.h"
#include "holotrace/data/target.h"
#include "holotrace/opencl/device.h"
#include "holotrace/slm/encode/iterate/frame_descent.h"

namespace holotrace {

/// The devices that params.device names for a gradient descent, which share its frames; none: the processor does it.
///
/// Under `auto` it is the device that is expected to be the fastest, by the rates of device_rates.h, with as many of its equals
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

}  // namespace holotrace
