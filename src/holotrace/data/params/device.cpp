#include "holotrace/data/params/device.h"

#include <charconv>

#include "holotrace/base/error.h"

namespace holotrace {

DeviceChoice parse_device(const std::string& text) {
  if (text == "cpu") return {DeviceKind::cpu};
  if (text == "auto") return {DeviceKind::automatic};
  if (text == "opencl") return {DeviceKind::opencl};
  const std::string before = "opencl:";
  int number = -1;
  if (text.starts_with(before)) {
    const char *begin = text.data() + before.size(), *end = text.data() + text.size();
    const auto [read, error] = std::from_chars(begin, end, number);
    if (error == std::errc() && read == end && number >= 0) return {DeviceKind::opencl, number};
  }
  fail("expected a device: cpu, auto, opencl or opencl:N with the number of a device, from 0; got \"{}\"", text);
}

std::string device_text(const DeviceChoice& choice) {
  if (choice.kind == DeviceKind::cpu) return "cpu";
  if (choice.kind == DeviceKind::automatic) return "auto";
  return choice.number == 0 ? "opencl" : fmt::format("opencl:{}", choice.number);
}

}  // namespace holotrace
