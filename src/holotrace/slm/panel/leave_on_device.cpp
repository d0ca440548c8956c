#include "holotrace/slm/panel/leave_on_device.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

#include "holotrace/slm/panel/device_panel.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/device_rates.h"
#include "holotrace/wave/shared/device_room.h"
#include "holotrace/wave/shared/fastest_device.h"
#include "holotrace/wave/shared/on_chosen_device.h"

namespace holotrace {
namespace {

// Starts of the kernels and waiting for them, on slow drivers [s].
constexpr double seconds_to_start = 1e-3;

// Bytes that a panel needs on a device at most, with all effects: for pixels of n × n samples 24·n(n + 1) + 72 each.
double bytes_on_device(const PanelModel& panel, const PanelPattern& pattern) {
  const double samples = double(panel.head().grid.pixels()), pixels = double(pattern.drive.size());
  return 24 * (samples + std::sqrt(samples * pixels)) + 72 * pixels;
}

DeviceField leave_on(Device& device, const PanelModel& panel, const PanelPattern& pattern) {
  const auto lock = device.lock();
  make_room(device, bytes_on_device(panel, pattern));
  DevicePanel there(device, panel);
  DevicePanel::Memory memory;
  const DeviceBuffer drive = device.upload(pattern.drive.values, "a panel");
  DeviceBuffer modulus;
  if (pattern.modulus) modulus = device.upload(pattern.modulus->values, "a panel");
  DeviceField field = make_device_field(device, panel.head(), "the light of a panel");
  there.leave({drive, pattern.modulus ? &modulus : nullptr}, field.samples, memory);
  device.finish();  // before its memory is released
  return field;
}

// What take(field) returns. @param returns  whether it fetches the field
template <class Take>
auto take_on_device(const PanelModel& panel, const PanelPattern& pattern, const DeviceChoice& choice, bool returns,
                    const Observer& observer, const Take& take) {
  if (choice.kind != DeviceKind::cpu) panel.check_pattern(pattern.drive, pattern.modulus);
  const auto fastest = [&] {
    const PanelWork work = panel.work();
    const int threads = int(std::max(1U, std::thread::hardware_concurrency()));
    const double transfers = work.sent + (returns ? work.fetched : 0);
    return fastest_device(predict_seconds(work.on_processor, summation_rates(), threads), [&](Device& there) {
      const DeviceRates rates = device_rates(there);
      return work.moved / rates.moved_bytes + transfers / rates.bytes + seconds_to_start;
    });
  };
  return on_chosen_device(choice, observer, fastest,
                          [&](Device& device) { return take(leave_on(device, panel, pattern)); });
}

}  // namespace

std::optional<Field> leave_on_device(const PanelModel& panel, const PanelPattern& pattern, const DeviceChoice& choice,
                                     const Observer& observer) {
  return take_on_device(panel, pattern, choice, true, observer, [](const DeviceField& field) { return fetch(field); });
}

std::optional<LeftField> leave_and_stay_on_device(const PanelModel& panel, const PanelPattern& pattern,
                                                  const DeviceChoice& choice, const Observer& observer) {
  return take_on_device(panel, pattern, choice, false, observer, [](DeviceField field) {
    const double there = power(field);
    return LeftField{std::move(field), there};
  });
}

}  // namespace holotrace
