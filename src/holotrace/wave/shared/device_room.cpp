#include "holotrace/wave/shared/device_room.h"

#include <mutex>
#include <utility>
#include <vector>

#include "holotrace/opencl/device.h"

namespace holotrace {
namespace {

using Drop = std::function<void(const Device&)>;

struct Drops {
  std::mutex mutex;
  std::vector<Drop> all;
};

// Never destroyed: threads may use devices until the program ends.
Drops& drops() {
  static auto& made = *new Drops;
  return made;
}

}  // namespace

void make_room(Device& device, double bytes) {
  const auto lock = device.lock();
  if (device.memory_left() >= bytes) return;
  std::vector<Drop> all;
  {
    const std::lock_guard of_drops(drops().mutex);
    all = drops().all;
  }
  for (const Drop& drop : all) drop(device);
}

void when_room_is_short(Drop drop) {
  const std::lock_guard lock(drops().mutex);
  drops().all.push_back(std::move(drop));
}

}  // namespace holotrace
