#include "holotrace/slm/encode/device_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace holotrace {
namespace {

constexpr const char* level_source =
#include "kernels/level_kernel.h.inc"
    ;
constexpr const char* pixel_source =
#include "kernels/pixel_levels.cl.inc"
    ;

constexpr size_t pixels_of_group = 64;

Kernel kernel_of_pixels(const char* name) {
  return {name, {level_source, pixel_source}, fmt::format("-D GROUP={}", pixels_of_group)};
}

// Calls run(count, buffer) for the levels of all pixels, and fetches them.
template <class Run>
void fetch_levels(const DeviceField& field, Array2D<uint16_t>& to, const Run& run) {
  Device& device = *field.device;
  const auto lock = device.lock();
  const size_t count = to.size();
  const DeviceBuffer levels = device.make_buffer(count * sizeof(uint16_t), "levels");
  run(WorkSize{(count + pixels_of_group - 1) / pixels_of_group, 1, pixels_of_group, 1}, int32_t(count), levels);
  device.read(levels, to.values.data(), levels.bytes());
}

}  // namespace

ModulusMoments modulus_moments(const DeviceField& field) {
  Device& device = *field.device;
  const auto lock = device.lock();
  const Grid& grid = field.head.grid;
  std::vector<float> rows(3 * size_t(grid.ny));
  const DeviceBuffer there = device.make_buffer(rows.size() * sizeof(float), "the moments of a field");
  device.run(kernel_of_pixels("row_moments"), {1, size_t(grid.ny), pixels_of_group, 1},
             {field.samples, int32_t(grid.nx), there});
  device.read(there, rows.data(), there.bytes());
  ModulusMoments moments;
  for (size_t row = 0; row < rows.size(); row += 3) {
    moments.largest = std::max(moments.largest, double(rows[row]));
    moments.sum += double(rows[row + 1]);
    moments.square += double(rows[row + 2]);
  }
  return moments;
}

void write_phase_levels(const DeviceField& field, bool is_conjugate, const PhaseLevels& levels, Array2D<uint16_t>& to) {
  fetch_levels(field, to, [&](const WorkSize& size, int32_t count, const DeviceBuffer& there) {
    field.device->run(
        kernel_of_pixels("phase_levels"), size,
        {field.samples, count, is_conjugate ? -1.0F : 1.0F, int32_t(levels.count()), float(levels.range()), there});
  });
}

void write_amplitude_levels(const DeviceField& field, double largest, int levels, Array2D<uint16_t>& to) {
  const float scale = largest > 0 ? float(1 / largest) : 0.0F;
  fetch_levels(field, to, [&](const WorkSize& size, int32_t count, const DeviceBuffer& there) {
    field.device->run(kernel_of_pixels("amplitude_levels"), size,
                      {field.samples, count, scale, int32_t(levels), there});
  });
}

}  // namespace holotrace
