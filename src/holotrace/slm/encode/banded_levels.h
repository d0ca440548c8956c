#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/slm/encode/banded_samples.h"
#include "holotrace/slm/encode/device_levels.h"

// What device_levels.h and device_moments.h do, for fields whose rows go to the device band by band. Each call sends all
// rows: 8 bytes per sample.

namespace holotrace {

ModulusMoments modulus_moments(const BandedSamples& field);

std::vector<int64_t> count_moduli(const BandedSamples& field, double largest, int steps);

/// Later calls get each sample divided by max(top, |u|).
double clip_moduli(BandedSamples& field, double top);

void write_phase_levels(const BandedSamples& field, bool is_conjugate, const PhaseLevels& levels,
                        Array2D<uint16_t>& to);

void write_amplitude_levels(const BandedSamples& field, double largest, int levels, Array2D<uint16_t>& to);

void write_double_phase_levels(const Scaled<BandedSamples>& inside, bool is_conjugate, const PhaseLevels& levels,
                               Array2D<uint16_t>& to);

void write_binary_levels(const ShownPixels<BandedSamples>& shown, const ReferenceWave& wave, const BinaryPair& pair,
                         Array2D<uint16_t>& to);

IrradianceRange irradiance_range(const ShownPixels<BandedSamples>& shown, const Interference& interference);

void write_irradiance_levels(const ShownPixels<BandedSamples>& shown, const Interference& interference,
                             const Transmittances& transmittances, int levels, Array2D<uint16_t>& to);

}  // namespace holotrace
