#pragma once

#include <functional>

namespace holotrace {

class Device;

inline constexpr double seconds_to_open_device = 0.3;

/// The device that is expected to do some work in the least time; none: the processor does.
///
/// A device that is not open yet counts 0.3 s more, which opening takes. Devices that do not work, or throw an Error, are
/// not chosen.
/// @param on_processor  seconds that the processor is expected to take
/// @param on_device     seconds that a device is expected to take; infinite if that is not known
Device* fastest_device(double on_processor, const std::function<double(Device& device)>& on_device);

}  // namespace holotrace
