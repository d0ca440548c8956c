#include "holotrace/data/params/device.h"

#include <charconv>

#include "holotrace/base/error.h"

namespace holotrace {

DeviceChoice parse_device(const std::string& text) {
  if (text == "cpu") return {DeviceKind::cpu};
  if (text == "auto") return {DeviceKind::automatic};
  if (text == "opencl") return {DeviceKind::opencl};
  if (text == "opencl:all") return {DeviceKind::all};
  const std::string before = "opencl:";
  int number = -1;
  if (text.starts_with(before)) {
    const char *begin = text.data() + before.size(), *end = text.data() + text.size();
    const auto [read, error] = std::from_chars(begin, end, number);
    if (error == std::errc() && read == end && number >= 0) return {DeviceKind::opencl, number};
  }
  fail("expected a device: cpu, auto, opencl, opencl:N with the number of a device, from 0, or opencl:all; got \"{}\"",
       text);
}

std::string device_text(const DeviceChoice& choice) {
  if (choice.kind == DeviceKind::cpu) return "cpu";
  if (choice.kind == DeviceKind::automatic) return "auto";
  if (choice.kind == DeviceKind::all) return "opencl:all";
  return choice.number == 0 ? "opencl" : fmt::format("opencl:{}", choice.number);
}

std::string device_help(const std::string& work, const std::string& all) {
  return "device that " + work +
         ": the processor (cpu); the first OpenCL device (opencl) or device N of \"holotrace info --devices\" "
         "(opencl:N), in single precision; " +
         all + "or the one that is expected to be faster (auto)";
}

void require_one_device(const DeviceChoice& choice, const std::string& about) {
  require(choice.kind != DeviceKind::all,
          "expected one device{}, got opencl:all; only the sum of waves and the method sgd run on all devices at once; "
          "use opencl or opencl:N",
          about);
}

}  // namespace holotrace
