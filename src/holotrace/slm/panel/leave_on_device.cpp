#include "holotrace/slm/panel/leave_on_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <thread>

#include "holotrace/base/error.h"
#include "holotrace/slm/panel/device_panel.h"
#include "holotrace/wave/shared/cost_model.h"
#include "holotrace/wave/shared/device_rates.h"
#include "holotrace/wave/shared/fastest_device.h"

namespace holotrace {
namespace {

constexpr double sample_bytes = sizeof(std::complex<float>);

// Starts of the kernels and waiting for them, on slow drivers [s].
constexpr double seconds_to_start = 1e-3;

Field leave_on(Device& device, const PanelModel& panel, const PanelPattern& pattern, const Observer& observer) {
  const auto lock = device.lock();
  DevicePanel there(device, panel);
  DevicePanel::Memory memory;
  const DeviceBuffer drive = device.upload(pattern.drive.values, "a panel");
  DeviceBuffer modulus;
  if (pattern.modulus) modulus = device.upload(pattern.modulus->values, "a panel");
  Field field = panel.dark_field();
  const DeviceBuffer u = device.make_buffer(field.samples.size() * sample_bytes, "the light of a panel");
  there.leave({drive, pattern.modulus ? &modulus : nullptr}, u, memory);
  device.read(u, field.samples.values.data(), u.bytes());
  observer.fact("device", device.info().name);
  return field;
}

}  // namespace

std::optional<Field> leave_on_device(const PanelModel& panel, const PanelPattern& pattern, const DeviceChoice& choice,
                                     const Observer& observer) {
  if (choice.kind == DeviceKind::cpu) return std::nullopt;
  panel.check_pattern(pattern.drive, pattern.modulus);
  if (choice.kind == DeviceKind::opencl) return leave_on(open_device(choice.number), panel, pattern, observer);
  const PanelWork work = panel.work();
  const int threads = int(std::max(1U, std::thread::hardware_concurrency()));
  Device* const device =
      fastest_device(predict_seconds(work.on_processor, summation_rates(), threads), [&](Device& there) {
        const DeviceRates rates = device_rates(there);
        return work.moved / rates.moved_bytes + work.sent / rates.bytes + seconds_to_start;
      });
  if (!device) return std::nullopt;
  try {
    return leave_on(*device, panel, pattern, observer);
  } catch (const Error& error) {
    observer.warn(fmt::format("the device auto: the processor took over, because {}", error.what()));
    return std::nullopt;
  }
}

}  // namespace holotrace
