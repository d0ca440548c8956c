#pragma once

#include <functional>

namespace holotrace {

class Device;

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

}  // namespace holotrace
