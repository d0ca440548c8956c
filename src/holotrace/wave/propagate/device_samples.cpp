#include <cstdint>

#include "holotrace/wave/propagate/propagate_on_device.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {
namespace {

constexpr const char* place_source =
#include "kernels/sample_place_kernel.h.inc"
    ;
constexpr const char* samples_source =
#include "kernels/device_samples.cl.inc"
    ;

Kernel kernel_of_samples(const char* name) { return {name, {place_source, samples_source}}; }

}  // namespace

DeviceBuffer irradiance_of(const DeviceField& field) {
  Device& device = *field.device;
  const auto lock = device.lock();
  const Grid& grid = field.head.grid;
  DeviceBuffer irradiance = device.make_buffer(size_t(grid.pixels()) * sizeof(float), "an irradiance");
  device.run(kernel_of_samples("irradiance"), items_of_rows(grid.nx, grid.ny),
             {field.samples, irradiance, int32_t(grid.nx)});
  return irradiance;
}

DeviceField on_window(const DeviceField& field, const WindowShift& to) {
  Device& device = *field.device;
  const auto lock = device.lock();
  DeviceField there = make_device_field(device, head_on(field.head, to.window, field.head.z));
  const Grid &from = field.head.grid, &window = to.window;
  device.run(kernel_of_samples("take_window"), items_of_rows(window.nx, window.ny),
             {field.samples, int32_t(from.nx), int32_t(from.ny), int32_t(to.right), int32_t(to.down), there.samples,
              int32_t(window.nx), int32_t(window.ny)});
  return there;
}

}  // namespace holotrace
