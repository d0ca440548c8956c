#include "holotrace/wave/propagate/device_samples.h"

#include <cstdint>

namespace holotrace {
namespace {

constexpr const char* samples_source =
#include "kernels/device_samples.cl.inc"
    ;

constexpr size_t samples_of_group = 64;

}  // namespace

DeviceBuffer irradiance_of(const DeviceField& field) {
  Device& device = *field.device;
  const auto lock = device.lock();
  const size_t count = size_t(field.head.grid.pixels());
  DeviceBuffer irradiance = device.make_buffer(count * sizeof(float), "an irradiance");
  device.run({"irradiance", {samples_source}},
             {(count + samples_of_group - 1) / samples_of_group, 1, samples_of_group, 1},
             {field.samples, irradiance, int32_t(count)});
  return irradiance;
}

DeviceField on_window(const DeviceField& field, const WindowShift& to) {
  Device& device = *field.device;
  const auto lock = device.lock();
  DeviceField there = make_device_field(device, head_on(field.head, to.window, field.head.z));
  const Grid &from = field.head.grid, &window = to.window;
  device.run({"take_window", {samples_source}},
             {(size_t(window.nx) + samples_of_group - 1) / samples_of_group, size_t(window.ny), samples_of_group, 1},
             {field.samples, int32_t(from.nx), int32_t(from.ny), int32_t(to.right), int32_t(to.down), there.samples,
              int32_t(window.nx), int32_t(window.ny)});
  return there;
}

}  // namespace holotrace
