#include "info_devices.h"

#include "facts.h"
#include "holotrace/base/cpu.h"
#include "holotrace/base/error.h"
#include "holotrace/base/printable.h"
#include "holotrace/base/thread_count.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/device.h"
#include "holotrace/wave/shared/device_rates.h"
#include "say.h"

namespace holotrace {
namespace {

// What a device does per second, as kept or measured now; why it does not work, if it does not.
struct Measured {
  DeviceRates rates;
  std::string fault;
};

Measured measured(const DeviceInfo& info) {
  try {
    return {device_rates(open_device(info.number)), ""};
  } catch (const Error& error) {
    return {{}, error.what()};
  }
}

Json facts_of(const DeviceInfo& info) {
  const auto& [rates, fault] = measured(info);
  Json facts = {{"device", device_text({DeviceKind::opencl, info.number})},
                {"name", info.name},
                {"type", type_name(info.type)},
                {"compute_units", info.compute_units},
                {"memory_bytes", int64_t(info.memory)},
                {"driver", info.driver},
                {"platform", info.platform},
                {"multiply_adds_per_second", rates.multiply_adds},
                {"bytes_per_second", rates.bytes},
                {"moved_bytes_per_second", rates.moved_bytes}};
  if (!fault.empty()) facts["fault"] = fault;
  return facts;
}

std::string line_of(const DeviceInfo& info) {
  return fmt::format("{:<12} {}: {} of {} units, {}; driver {} ({})", device_text({DeviceKind::opencl, info.number}),
                     info.name, type_name(info.type), info.compute_units, format_bytes(info.memory), info.driver,
                     info.platform);
}

std::string rates_line_of(const DeviceInfo& info) {
  const auto& [rates, fault] = measured(info);
  if (!fault.empty()) return "does not work: " + fault;
  return fmt::format("sums waves at {:.3g} multiply-adds/s; propagates at {:.3g} bytes/s; transfers {:.3g} bytes/s",
                     rates.multiply_adds, rates.moved_bytes, rates.bytes);
}

}  // namespace

void print_devices(bool is_json) {
  std::vector<DeviceInfo> devices;
  std::string why_none = "no driver for OpenCL is installed";
  try {
    devices = list_devices();
  } catch (const Error& error) {
    why_none = error.what();
  }
  if (is_json) {
    Json json = {{"devices", Json::array({{{"device", "cpu"}, {"name", cpu_name()}, {"threads", thread_count()}}})}};
    for (const DeviceInfo& info : devices) json["devices"].push_back(facts_of(info));
    return print_facts(json, true);
  }
  fmt::print("{:<12} {}, {} threads\n", "cpu", printable(cpu_name()), thread_count());
  for (const DeviceInfo& info : devices)
    fmt::print("{}\n{:<12} {}\n", printable(line_of(info)), "", printable(rates_line_of(info)));
  if (devices.empty()) say("no OpenCL devices: {}\n", printable(why_none));
}

}  // namespace holotrace
