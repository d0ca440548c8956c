#include "holotrace/wave/shared/device_field.h"

#include <fmt/format.h>

#include <complex>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace holotrace {
namespace {

constexpr const char* place_source =
#include "kernels/sample_place_kernel.h.inc"
    ;
constexpr const char* sum_source =
#include "kernels/compensated_sum_kernel.h.inc"
    ;
constexpr const char* field_source =
#include "kernels/device_field.cl.inc"
    ;

Kernel kernel_of_fields(const char* name) {
  return {name, {place_source, sum_source, field_source}, fmt::format("-D GROUP={}", samples_of_group)};
}

}  // namespace

Field head_of(const Field& field) {
  Field head;
  head.grid = field.grid;
  head.wavelength = field.wavelength;
  head.z = field.z;
  copy_properties(field, head);
  return head;
}

Field head_on(const Field& field, const Grid& window, double z) {
  Field head;
  head.grid = window;
  head.wavelength = field.wavelength;
  head.z = z;
  copy_properties(field, head);
  return head;
}

DeviceField make_device_field(Device& device, Field head, const std::string& what) {
  DeviceBuffer samples = device.make_buffer(size_t(head.grid.pixels()) * sizeof(std::complex<float>), what);
  return {&device, std::move(head), std::move(samples)};
}

DeviceField send(Device& device, const Field& field, const std::string& what) {
  const auto lock = device.lock();
  DeviceField there = make_device_field(device, head_of(field), what);
  device.write(there.samples, field.samples.values.data(), there.samples.bytes());
  return there;
}

Field fetch(const DeviceField& field) {
  const auto lock = field.device->lock();
  Field here = field.head;
  here.samples = Array2D<std::complex<float>>::unset(here.grid.ny, here.grid.nx);
  field.device->read(field.samples, here.samples.values.data(), field.samples.bytes());
  return here;
}

void clear(DeviceField& field) {
  const auto lock = field.device->lock();
  const Grid& grid = field.head.grid;
  field.device->run(kernel_of_fields("clear"), items_of_rows(grid.nx, grid.ny), {int32_t(grid.nx), field.samples});
}

void put(const DeviceBuffer& from, const PixelBox& box, DeviceField& to) {
  const auto lock = to.device->lock();
  const int columns = box.x1 - box.x0;
  to.device->run(kernel_of_fields("put_box"), items_of_rows(columns, box.y1 - box.y0),
                 {from, int32_t(columns), int32_t(to.head.grid.nx), int32_t(box.x0), int32_t(box.y0),
                  KernelArgument::moving(to.samples, from.bytes())});
}

double energy(const DeviceField& field, const PixelBox& box) {
  Device& device = *field.device;
  const auto lock = device.lock();
  std::vector<float> sums(size_t(box.y1 - box.y0));
  const DeviceBuffer there = device.make_buffer(sums.size() * sizeof(float), "the energy of a field");
  device.run(kernel_of_fields("row_energies"), groups_of_rows(box.y1 - box.y0),
             {field.samples, int32_t(field.head.grid.nx), int32_t(box.x0), int32_t(box.x1), int32_t(box.y0), there});
  device.read(there, sums.data(), there.bytes());
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

double power(const DeviceField& field) {
  const Grid& grid = field.head.grid;
  return energy(field, {0, grid.nx, 0, grid.ny}) * grid.pitch * grid.pitch;
}

}  // namespace holotrace
