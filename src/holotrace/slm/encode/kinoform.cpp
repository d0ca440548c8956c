#include "holotrace/slm/encode/kinoform.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "holotrace/base/threads.h"
#include "holotrace/slm/panel/pixel_kernel.h"

namespace holotrace {
namespace {

void write_amplitude_levels(const Field& field, double largest, int levels, Array2D<uint16_t>& to) {
  const double scale = largest > 0 ? 1 / largest : 0;
  parallel_for(0, field.grid.ny, [&](int64_t j) {
    const std::complex<float>* u = field.samples.row(int(j));
    uint16_t* level = to.row(int(j));
    for (int i = 0; i < field.grid.nx; ++i)
      level[i] = uint16_t(amplitude_level(std::abs(std::complex<double>(u[i])) * scale, levels));
  });
}

void tell_amplitudes(const Field& field, const ModulusMoments& moments, const Observer& observer) {
  observer.fact("modulus_max", Fact(moments.largest));
  const double scale = moments.largest > 0 ? 1 / moments.largest : 0;
  observer.fact("mean_transmittance", Fact(moments.sum * scale / double(field.grid.pixels())));
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

void encode_phase(const Field& field, const PhaseLevels& levels, Hologram& hologram) {
  const ModulusMoments moments = modulus_moments(field);
  hologram.illumination = moments.sum > 0 ? std::pow(moments.square / moments.sum, 2) : 0;
  write_phase_levels(field.samples, false, levels, hologram.level);
}

void encode_amplitude(const Field& field, const Observer& observer, Hologram& hologram) {
  const ModulusMoments moments = modulus_moments(field);
  write_amplitude_levels(field, moments.largest, hologram.levels, hologram.level);
  hologram.illumination = moments.largest * moments.largest;
  tell_amplitudes(field, moments, observer);
}

void encode_complex(const Field& field, const PhaseLevels& levels, const Observer& observer, Hologram& hologram) {
  const ModulusMoments moments = modulus_moments(field);
  write_phase_levels(field.samples, false, levels, hologram.level);
  hologram.modulus_level = Array2D<uint16_t>(field.grid.ny, field.grid.nx);
  write_amplitude_levels(field, moments.largest, hologram.levels, hologram.modulus_level);
  hologram.illumination = moments.largest * moments.largest;
  tell_amplitudes(field, moments, observer);
}

}  // namespace holotrace
