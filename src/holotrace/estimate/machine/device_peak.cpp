#include <algorithm>

#include "holotrace/estimate/machine/ceilings.h"
#include "holotrace/estimate/machine/timing.h"

namespace holotrace {
namespace {

constexpr const char* source =
#include "kernels/device_peak.cl.inc"
    ;

constexpr size_t group = 64;
constexpr double long_enough = 0.01;  // [s]

// The best rate of three runs, with the work doubled until one takes long enough.
template <class Run>
double peak_of(Device& device, double amount, const Run& run) {
  const auto seconds = [&](int times) {
    return seconds_of([&] {
      for (int i = 0; i < times; ++i) run();
      device.finish();
    });
  };
  seconds(1);  // compiles the kernel
  int times = 1;
  while (seconds(times) < long_enough && times < 1 << 20) times *= 2;
  double best = 0;
  for (int round = 0; round < 3; ++round) best = std::max(best, times * amount / std::max(seconds(times), 1e-9));
  return best;
}

}  // namespace

DevicePeak measure_device_peak(Device& device) {
  const auto lock = device.lock();
  DevicePeak peak;
  {
    const size_t groups = size_t(device.info().compute_units) * 64;
    constexpr int rounds = 256;
    const DeviceBuffer sums = device.make_buffer(groups * group * sizeof(float), "a measurement");
    peak.multiply_adds = peak_of(device, 32.0 * rounds * double(groups * group), [&] {
      device.run({"multiply_adds", {source}}, {groups, 1, group, 1}, {sums, 0.5F, int32_t(rounds)});
    });
  }
  constexpr size_t bytes = size_t(32) << 20, item = 16;
  const DeviceBuffer from = device.make_buffer(bytes, "a measurement"), to = device.make_buffer(bytes, "a measurement");
  peak.memory = peak_of(device, 2.0 * double(bytes), [&] {
    device.run({"copy", {source}}, {bytes / item / group, 1, group, 1}, {from, to});
  });
  return peak;
}

}  // namespace holotrace
