#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/slm/encode/device_samples.h"
#include "holotrace/slm/encode/sample_loops.h"
#include "holotrace/wave/shared/device_field.h"

// The moduli of a field on an OpenCL device, in single precision. Errors are those of Device. Transfers, beside those of
// each_band, are said at each.

namespace holotrace {

/// The power of two that scales moduli of up to `largest` to 1 … 2, exactly, so that their squares are within single
/// precision; 1 for 0. It is within 2^±126: moduli below 1e-38 stay smaller.
float unit_for(double largest);

/// The moments of |U| over the panel, within 1e-6 of them. They are not finite if a sample is not; any finite samples will do.
/// Samples whose parts are below 1e-38 may count as 0.
/// Transfer: 16 bytes per row.
ModulusMoments modulus_moments(const DeviceField& field);
ModulusMoments modulus_moments(const DeviceSamples& field);

/// The number of samples in each of so many equal steps of modulus from 0 to `largest`, and last those of `largest` itself.
/// A modulus within 2e-7 of `largest` of a step's edge may count for its neighbour.
/// @param at_once  samples, in whole rows, that are counted in 32 bits
/// Transfer: 4 bytes per step in and out, as often.
std::vector<int64_t> count_moduli(const DeviceField& field, double largest, int steps,
                                  int64_t at_once = int64_t(1) << 31);
std::vector<int64_t> count_moduli(const DeviceSamples& field, double largest, int steps);

/// Scales the samples on the device to moduli of at most 1: u/max(top, |u|).
/// @return Σ(|u|² − top²) of the samples above `top`
/// Transfer: 4 bytes per row.
double clip_moduli(const DeviceField& field, double top);
double clip_moduli(DeviceSamples& field, double top);

}  // namespace holotrace
