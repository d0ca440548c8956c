#pragma once

#include <cstdint>

#include "holotrace/base/array.h"
#include "holotrace/opencl/device.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/sample_kernels.h"
#include "holotrace/wave/shared/device_field.h"

// What the encoders of kinoform.h do with a field on an OpenCL device, in single precision. Errors are those of Device.

namespace holotrace {

/// The moments of |U| over the panel. They are not finite if a sample is not, or if its square is beyond single precision.
/// Transfer: 12 bytes per row.
ModulusMoments modulus_moments(const DeviceField& field);

/// The level of each sample's phase, or of that of its conjugate, for levels without a table (PhaseLevels::has_table). A
/// phase within 1e-6 turns of the middle between two levels may get the other one. Transfer: 2 bytes per pixel.
void write_phase_levels(const DeviceField& field, bool is_conjugate, const PhaseLevels& levels, Array2D<uint16_t>& to);

/// The level of |U|/largest. Transfer: 2 bytes per pixel.
void write_amplitude_levels(const DeviceField& field, double largest, int levels, Array2D<uint16_t>& to);

}  // namespace holotrace
