#include "holotrace/slm/encode/device_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "holotrace/wave/shared/sample_rows.h"

namespace holotrace {
namespace {

constexpr const char* place_of_sample =
#include "kernels/sample_place_kernel.h.inc"
    ;
constexpr const char* level_source =
#include "kernels/level_kernel.h.inc"
    ;
constexpr const char* interference_source =
#include "kernels/interference_kernel.h.inc"
    ;
constexpr const char* double_phase_source =
#include "kernels/double_phase_kernel.h.inc"
    ;
constexpr const char* pixel_source =
#include "kernels/pixel_levels.cl.inc"
    ;

Kernel kernel_of_pixels(const char* name) {
  return {name,
          {place_of_sample, level_source, interference_source, double_phase_source, pixel_source},
          fmt::format("-D GROUP={}", samples_of_group)};
}

// Calls run(work size, buffer) for the levels of all pixels, and fetches them.
template <class Run>
void fetch_levels(const DeviceField& field, Array2D<uint16_t>& to, const Run& run) {
  Device& device = *field.device;
  const auto lock = device.lock();
  const DeviceBuffer levels = device.make_buffer(to.size() * sizeof(uint16_t), "levels");
  run(items_of_rows(to.nx, to.ny), levels);
  device.read(levels, to.values.data(), levels.bytes());
}

// A reference wave on a device, for samples that are scaled by `unit`.
struct WaveThere {
  DeviceBuffer along_x, along_y;
  float unit = 1;
};

WaveThere send_wave(const ShownPixels<DeviceField>& shown, const ReferenceWave& wave) {
  const auto upload = [&](const std::vector<std::complex<double>>& factors) {
    return shown.field.device->upload(std::vector<std::complex<float>>(factors.begin(), factors.end()),
                                      "a reference wave");
  };
  return {upload(wave.along_x), upload(wave.along_y), unit_for(shown.moments.largest)};
}

}  // namespace

void write_phase_levels(const DeviceField& field, bool is_conjugate, const PhaseLevels& levels, Array2D<uint16_t>& to) {
  fetch_levels(field, to, [&](const WorkSize& size, const DeviceBuffer& there) {
    field.device->run(kernel_of_pixels("phase_levels"), size,
                      {field.samples, int32_t(to.nx), is_conjugate ? -1.0F : 1.0F, int32_t(levels.count()),
                       float(levels.range()), there});
  });
}

void write_amplitude_levels(const DeviceField& field, double largest, int levels, Array2D<uint16_t>& to) {
  const float unit = unit_for(largest), scale = largest > 0 ? float(1 / (largest * double(unit))) : 0.0F;
  fetch_levels(field, to, [&](const WorkSize& size, const DeviceBuffer& there) {
    field.device->run(kernel_of_pixels("amplitude_levels"), size,
                      {field.samples, int32_t(to.nx), unit, scale, int32_t(levels), there});
  });
}

void write_double_phase_levels(const ScaledField& inside, bool is_conjugate, const PhaseLevels& levels,
                               Array2D<uint16_t>& to) {
  const DeviceField& light = inside.light;
  fetch_levels(light, to, [&](const WorkSize& size, const DeviceBuffer& there) {
    light.device->run(kernel_of_pixels("double_phase_levels"), size,
                      {light.samples, int32_t(to.nx), is_conjugate ? -1.0F : 1.0F, int32_t(levels.count()),
                       float(levels.range()), there});
  });
}

void write_binary_levels(const ShownPixels<DeviceField>& shown, const ReferenceWave& wave, const BinaryPair& pair,
                         Array2D<uint16_t>& to) {
  fetch_levels(shown.field, to, [&](const WorkSize& size, const DeviceBuffer& there) {
    const WaveThere reference = send_wave(shown, wave);
    shown.field.device->run(kernel_of_pixels("binary_levels"), size,
                            {shown.field.samples, int32_t(to.nx), reference.unit, reference.along_x, reference.along_y,
                             int32_t(pair.above), int32_t(pair.below), there});
    shown.field.device->finish();  // before the wave is released
  });
}

IrradianceRange irradiance_range(const ShownPixels<DeviceField>& shown, const Interference& interference) {
  Device& device = *shown.field.device;
  const auto lock = device.lock();
  const Grid& grid = shown.field.head.grid;
  const WaveThere reference = send_wave(shown, interference.wave);
  const double unit = double(reference.unit);
  std::vector<float> rows(2 * size_t(grid.ny));
  const DeviceBuffer there = device.make_buffer(rows.size() * sizeof(float), "the irradiance of rows");
  device.run(kernel_of_pixels("irradiance_ranges"), groups_of_rows(grid.ny),
             {shown.field.samples, int32_t(grid.nx), reference.unit, reference.along_x, reference.along_y,
              float(interference.reference * unit), int32_t(interference.with_bias), there});
  device.read(there, rows.data(), there.bytes());
  IrradianceRange range{double(rows[0]), double(rows[1])};
  for (size_t row = 0; row < rows.size(); row += 2)
    range = {std::min(range.least, double(rows[row])), std::max(range.largest, double(rows[row + 1]))};
  return {range.least / (unit * unit), range.largest / (unit * unit)};
}

void write_irradiance_levels(const ShownPixels<DeviceField>& shown, const Interference& interference,
                             const Transmittances& transmittances, int levels, Array2D<uint16_t>& to) {
  fetch_levels(shown.field, to, [&](const WorkSize& size, const DeviceBuffer& there) {
    const WaveThere reference = send_wave(shown, interference.wave);
    const double unit = double(reference.unit);
    shown.field.device->run(kernel_of_pixels("irradiance_levels"), size,
                            {shown.field.samples, int32_t(to.nx), reference.unit, reference.along_x, reference.along_y,
                             float(interference.reference * unit), int32_t(interference.with_bias),
                             float(transmittances.offset * unit * unit), float(transmittances.scale / (unit * unit)),
                             int32_t(levels), there});
    shown.field.device->finish();  // before the wave is released
  });
}

}  // namespace holotrace
