#include "holotrace/slm/encode/kinoform.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/threads.h"
#include "holotrace/slm/encode/device_levels.h"
#include "holotrace/slm/panel/pixel_kernel.h"

namespace holotrace {
namespace {

// The level of each sample's phase, or of that of its conjugate.
void write_phase_levels(const Field& field, bool is_conjugate, const PhaseLevels& levels, Array2D<uint16_t>& to) {
  write_phase_levels(field.samples, is_conjugate, levels, to);
}

// The level of |U|/largest.
void write_amplitude_levels(const Field& field, double largest, int levels, Array2D<uint16_t>& to) {
  const double scale = largest > 0 ? 1 / largest : 0;
  parallel_for(0, field.grid.ny, [&](int64_t j) {
    const std::complex<float>* u = field.samples.row(int(j));
    uint16_t* level = to.row(int(j));
    for (int i = 0; i < field.grid.nx; ++i)
      level[i] = uint16_t(amplitude_level(std::abs(std::complex<double>(u[i])) * scale, levels));
  });
}

// For levels without a table (PhaseLevels::has_table). A phase within 1e-6 turns of the middle between two levels may get the
// other one.
void write_phase_levels(const DeviceSamples& field, bool is_conjugate, const PhaseLevels& levels,
                        Array2D<uint16_t>& to) {
  fetch_levels(field, to, [&](const DeviceField& band, int, const WorkSize& size, const DeviceBuffer& there) {
    band.device->run(kernel_of_pixels("phase_levels"), size,
                     {band.samples, int32_t(to.nx), is_conjugate ? -1.0F : 1.0F, int32_t(levels.count()),
                      float(levels.range()), there});
  });
}

void write_amplitude_levels(const DeviceSamples& field, double largest, int levels, Array2D<uint16_t>& to) {
  const float unit = unit_for(largest), scale = largest > 0 ? float(1 / (largest * double(unit))) : 0.0F;
  fetch_levels(field, to, [&](const DeviceField& band, int, const WorkSize& size, const DeviceBuffer& there) {
    band.device->run(kernel_of_pixels("amplitude_levels"), size,
                     {band.samples, int32_t(to.nx), unit, scale, int32_t(levels), there});
  });
}

// The levels of |U|/max|U|, the hologram's illumination, and facts.
template <class AnyField>
void encode_moduli(const ShownPixels<AnyField>& shown, const Observer& observer, Array2D<uint16_t>& to,
                   Hologram& hologram) {
  const double largest = shown.moments.largest, scale = largest > 0 ? 1 / largest : 0;
  write_amplitude_levels(shown.field, largest, hologram.levels, to);
  hologram.illumination = largest * largest;
  observer.fact("modulus_max", Fact(largest));
  observer.fact("mean_transmittance", Fact(shown.moments.sum * scale / double(hologram.grid.pixels())));
}

}  // namespace

ModulusMoments modulus_moments(const Field& field) {
  std::vector<ModulusMoments> rows(size_t(field.grid.ny));  // added in order: the same on any number of threads
  parallel_for(0, field.grid.ny,
               [&](int64_t j) { rows[size_t(j)] = modulus_moments(field.samples.row(int(j)), size_t(field.grid.nx)); });
  ModulusMoments moments;
  for (const ModulusMoments& row : rows) {
    moments.largest = std::max(moments.largest, row.largest);
    moments.sum += row.sum;
    moments.square += row.square;
  }
  return moments;
}

template <class AnyField>
void encode_phase(const ShownPixels<AnyField>& shown, const PhaseLevels& levels, Hologram& hologram) {
  const ModulusMoments& moments = shown.moments;
  hologram.illumination = moments.sum > 0 ? std::pow(moments.square / moments.sum, 2) : 0;
  write_phase_levels(shown.field, shown.is_conjugate, levels, hologram.level);
}

template <class AnyField>
void encode_amplitude(const ShownPixels<AnyField>& shown, const Observer& observer, Hologram& hologram) {
  encode_moduli(shown, observer, hologram.level, hologram);
}

template <class AnyField>
void encode_complex(const ShownPixels<AnyField>& shown, const PhaseLevels& levels, const Observer& observer,
                    Hologram& hologram) {
  write_phase_levels(shown.field, shown.is_conjugate, levels, hologram.level);
  hologram.modulus_level = hologram.level;  // of the same size
  encode_moduli(shown, observer, hologram.modulus_level, hologram);
}

template void encode_phase(const ShownPixels<Field>&, const PhaseLevels&, Hologram&);
template void encode_phase(const ShownPixels<DeviceSamples>&, const PhaseLevels&, Hologram&);
template void encode_amplitude(const ShownPixels<Field>&, const Observer&, Hologram&);
template void encode_amplitude(const ShownPixels<DeviceSamples>&, const Observer&, Hologram&);
template void encode_complex(const ShownPixels<Field>&, const PhaseLevels&, const Observer&, Hologram&);
template void encode_complex(const ShownPixels<DeviceSamples>&, const PhaseLevels&, const Observer&, Hologram&);

}  // namespace holotrace
