#include "holotrace/slm/encode/banded_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace holotrace {
namespace {

// Calls write(band, its first row, its levels) for each band.
template <class Write>
void write_bands(const BandedSamples& field, Array2D<uint16_t>& to, const Write& write) {
  for_each_band(field, [&](DeviceField& band, int first) {
    Array2D<uint16_t> levels(band.head.grid.ny, to.nx);
    write(band, first, levels);
    std::copy(levels.values.begin(), levels.values.end(), to.row(first));
  });
}

ShownPixels<DeviceField> shown_in(const ShownPixels<BandedSamples>& shown, const DeviceField& band) {
  return {band, shown.moments, shown.is_conjugate};
}

ReferenceWave wave_in(const ReferenceWave& wave, const DeviceField& band, int first) {
  const auto row = wave.along_y.begin() + first;
  return {wave.along_x, {row, row + band.head.grid.ny}};
}

Interference interference_in(const Interference& all, const DeviceField& band, int first) {
  return {wave_in(all.wave, band, first), all.reference, all.with_bias};
}

}  // namespace

ModulusMoments modulus_moments(const BandedSamples& field) {
  ModulusMoments all;
  for_each_band(field, [&](DeviceField& band, int) {
    const ModulusMoments of_band = modulus_moments(band);
    // std::max(a, b) is a if a is not a number.
    all.largest = std::isfinite(of_band.largest) ? std::max(all.largest, of_band.largest) : of_band.largest;
    all.sum += of_band.sum;
    all.square += of_band.square;
  });
  return all;
}

std::vector<int64_t> count_moduli(const BandedSamples& field, double largest, int steps) {
  std::vector<int64_t> counts(size_t(steps) + 1);
  for_each_band(field, [&](DeviceField& band, int) {
    const std::vector<int64_t> of_band = count_moduli(band, largest, steps);
    for (size_t step = 0; step < counts.size(); ++step) counts[step] += of_band[step];
  });
  return counts;
}

double clip_moduli(BandedSamples& field, double top) {
  double clipped = 0;
  for_each_band(field, [&](DeviceField& band, int) { clipped += clip_moduli(band, top); });
  field.top = top;
  return clipped;
}

void write_phase_levels(const BandedSamples& field, bool is_conjugate, const PhaseLevels& levels,
                        Array2D<uint16_t>& to) {
  write_bands(field, to, [&](const DeviceField& band, int, Array2D<uint16_t>& there) {
    write_phase_levels(band, is_conjugate, levels, there);
  });
}

void write_amplitude_levels(const BandedSamples& field, double largest, int levels, Array2D<uint16_t>& to) {
  write_bands(field, to, [&](const DeviceField& band, int, Array2D<uint16_t>& there) {
    write_amplitude_levels(band, largest, levels, there);
  });
}

// Bands begin at even rows, where the chessboard of double phases does.
void write_double_phase_levels(const Scaled<BandedSamples>& inside, bool is_conjugate, const PhaseLevels& levels,
                               Array2D<uint16_t>& to) {
  write_bands(inside.light, to, [&](DeviceField& band, int, Array2D<uint16_t>& there) {
    write_double_phase_levels(ScaledField{std::move(band), inside.scale}, is_conjugate, levels, there);
  });
}

void write_binary_levels(const ShownPixels<BandedSamples>& shown, const ReferenceWave& wave, const BinaryPair& pair,
                         Array2D<uint16_t>& to) {
  write_bands(shown.field, to, [&](const DeviceField& band, int first, Array2D<uint16_t>& there) {
    write_binary_levels(shown_in(shown, band), wave_in(wave, band, first), pair, there);
  });
}

IrradianceRange irradiance_range(const ShownPixels<BandedSamples>& shown, const Interference& interference) {
  constexpr double none = std::numeric_limits<double>::infinity();
  IrradianceRange range{none, -none};
  for_each_band(shown.field, [&](const DeviceField& band, int first) {
    const IrradianceRange of_band = irradiance_range(shown_in(shown, band), interference_in(interference, band, first));
    range = {std::min(range.least, of_band.least), std::max(range.largest, of_band.largest)};
  });
  return range;
}

void write_irradiance_levels(const ShownPixels<BandedSamples>& shown, const Interference& interference,
                             const Transmittances& transmittances, int levels, Array2D<uint16_t>& to) {
  write_bands(shown.field, to, [&](const DeviceField& band, int first, Array2D<uint16_t>& there) {
    write_irradiance_levels(shown_in(shown, band), interference_in(interference, band, first), transmittances, levels,
                            there);
  });
}

}  // namespace holotrace
