#include "holotrace/wave/shared/device_room.h"

#include <mutex>
#include <utility>
#include <vector>

#include "holotrace/opencl/device.h"

namespace holotrace {
namespace {

struct AllKept {
  std::mutex mutex;
  std::vector<KeptOnDevices> all;
};

// Never destroyed: threads may use devices until the program ends.
AllKept& all_kept() {
  static auto& made = *new AllKept;
  return made;
}

// A copy: what is kept has locks of its own.
std::vector<KeptOnDevices> kept_by_all() {
  const std::lock_guard lock(all_kept().mutex);
  return all_kept().all;
}

}  // namespace

void keep_until_room_is_short(KeptOnDevices kept) {
  const std::lock_guard lock(all_kept().mutex);
  all_kept().all.push_back(std::move(kept));
}

void make_room(Device& device, double bytes) {
  const auto lock = device.lock();
  if (device.memory_left() >= bytes) return;
  for (const KeptOnDevices& kept : kept_by_all()) kept.drop(device);
}

double possible_room(const Device& device) {
  double bytes = device.memory_left();
  for (const KeptOnDevices& kept : kept_by_all()) bytes += kept.bytes(device);
  return bytes;
}

}  // namespace holotrace
