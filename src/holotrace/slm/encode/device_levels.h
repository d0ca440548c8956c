#pragma once

#include <cstdint>

#include "holotrace/base/array.h"
#include "holotrace/slm/encode/binary.h"
#include "holotrace/slm/encode/device_low_pass.h"
#include "holotrace/slm/encode/device_moments.h"
#include "holotrace/slm/encode/off_axis.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/shown_pixels.h"
#include "holotrace/wave/shared/device_field.h"

// The loops over pixels of the encoders, for fields on an OpenCL device, in single precision. Errors are those of Device.
// Transfers: 2 bytes per pixel come back; besides, what is said at each.

namespace holotrace {

/// The level of each sample's phase, or of that of its conjugate, for levels without a table (PhaseLevels::has_table). A
/// phase within 1e-6 turns of the middle between two levels may get the other one.
void write_phase_levels(const DeviceField& field, bool is_conjugate, const PhaseLevels& levels, Array2D<uint16_t>& to);

/// The level of |U|/largest.
void write_amplitude_levels(const DeviceField& field, double largest, int levels, Array2D<uint16_t>& to);

/// As write_double_phase_levels of double_phase.h, for levels without a table. Single precision knows the phases
/// arg U ± acos(a) of samples of modulus a within 2e-7·(1/a + 1/√(1 − a²)) turns, near a = 1 within 1e-4. Pixels that are
/// farther from the middle between two levels get those of the processor.
void write_double_phase_levels(const ScaledField& inside, bool is_conjugate, const PhaseLevels& levels,
                               Array2D<uint16_t>& to);

/// As write_binary_levels of binary.h. Where |Re(U·R*)| is below 1e-6·|U| the other level may be taken. Transfer: 8 bytes
/// per row and column to the device.
void write_binary_levels(const ShownPixels<DeviceField>& shown, const ReferenceWave& wave, const BinaryPair& pair,
                         Array2D<uint16_t>& to);

/// As irradiance_range of off_axis.h, within 1e-6 of (|U| + |R|)². Transfers: 8 bytes per row and column to the device; 8
/// per row come back instead of levels.
IrradianceRange irradiance_range(const ShownPixels<DeviceField>& shown, const Interference& interference);

/// As write_irradiance_levels of off_axis.h. Transfer: 8 bytes per row and column to the device.
void write_irradiance_levels(const ShownPixels<DeviceField>& shown, const Interference& interference,
                             const Transmittances& transmittances, int levels, Array2D<uint16_t>& to);

}  // namespace holotrace
