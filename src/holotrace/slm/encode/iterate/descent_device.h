#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/target.h"
#include "holotrace/opencl/device.h"
#include "holotrace/slm/encode/iterate/frame_descent.h"

namespace holotrace {

/// The device that params.device names for a gradient descent; none: the processor does it.
///
/// The device `auto` is the one that is expected to be the fastest, by the rates of device_rates.h. Views through pupils
/// stay on the processor, with a warning.
/// @throws Error  for a device that is not there, and for views on a named one
Device* device_for_descent(const TargetSet& targets, const DescentSetup& setup, const std::vector<Hologram>& frames,
                           const Observer& observer);

}  // namespace holotrace
