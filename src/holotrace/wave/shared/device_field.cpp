#include "holotrace/wave/shared/device_field.h"

#include <fmt/format.h>

#include <complex>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace holotrace {
namespace {

constexpr const char* row_energies_source =
#include "kernels/device_field.cl.inc"
    ;

constexpr size_t items_of_row = 64;

}  // namespace

Field head_of(const Field& field) {
  Field head;
  head.grid = field.grid;
  head.wavelength = field.wavelength;
  head.z = field.z;
  head.image = field.image;
  head.filter = field.filter;
  head.name = field.name;
  head.frame = field.frame;
  head.cone_wavelength = field.cone_wavelength;
  return head;
}

Field head_on(const Field& field, const Grid& window, double z) {
  Field head;
  head.grid = window;
  head.wavelength = field.wavelength;
  head.z = z;
  head.image = field.image;
  head.filter = field.filter;
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
  here.samples = Array2D<std::complex<float>>(here.grid.ny, here.grid.nx);
  field.device->read(field.samples, here.samples.values.data(), field.samples.bytes());
  return here;
}

double power(const DeviceField& field) {
  Device& device = *field.device;
  const auto lock = device.lock();
  const Grid& grid = field.head.grid;
  std::vector<float> sums(size_t(grid.ny));
  const DeviceBuffer there = device.make_buffer(sums.size() * sizeof(float), "the power of a field");
  device.run({"row_energies", {row_energies_source}, fmt::format("-D GROUP={}", items_of_row)},
             {1, sums.size(), items_of_row, 1}, {field.samples, int32_t(grid.nx), there});
  device.read(there, sums.data(), there.bytes());
  return std::accumulate(sums.begin(), sums.end(), 0.0) * grid.pitch * grid.pitch;
}

}  // namespace holotrace
