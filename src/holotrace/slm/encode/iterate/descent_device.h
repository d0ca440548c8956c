#pragma once

#include <cstddef>
#include <vector>

#include "holotrace/data/target.h"
#include "holotrace/opencl/device.h"
#include "holotrace/slm/encode/iterate/frame_descent.h"

namespace holotrace {

/// The device that params.device names for a gradient descent; none: the processor does it.
///
/// The device `auto` is the one that is expected to be the fastest, by the rates of device_rates.h.
/// @param frames  their number
/// @throws Error  for a device that is not there
Device* device_for_descent(const std::vector<TargetPlane>& targets, const DescentSetup& setup, size_t frames);

/// The same for Gerchberg–Saxton, whose iterations use all planes.
Device* device_for_projections(const std::vector<TargetPlane>& targets, const DescentSetup& setup);

}  // namespace holotrace
