#pragma once

#include <functional>

namespace holotrace {

class Device;

/// Makes room on a device: if fewer bytes of its memory are left, all that is kept there for later is dropped. A caller
/// whose room no other thread may take holds the device's lock until it has its memory.
void make_room(Device& device, double bytes);

/// From here on, drop(device) is called, under the device's lock, to drop what a stage keeps there for later.
void when_room_is_short(std::function<void(const Device& device)> drop);

}  // namespace holotrace
