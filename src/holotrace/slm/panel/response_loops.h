#pragma once

#include <array>
#include <cstddef>

// Loops over the drives of one row of pixels with a calibration (PixelResponse), compiled for every instruction set.

namespace holotrace {

/// Cycles, amplitude and their slopes at whole levels; linear between them. Drives outside are clipped.
struct ResponseKnots {
  const std::array<float, 4>* knots;
  size_t count;  ///< ≥ 1
};

/// The cycles and amplitudes of `count` drives; nullptr: not wanted.
void respond(const ResponseKnots& knots, const float* drive, size_t count, float* cycles, float* amplitudes);

/// Gradient by the drives, from that by cycles and amplitudes:
///
///     of_drive = ∂cycles/∂drive·of_cycles + factor·modulus·∂amplitude/∂drive·of_amplitudes
///
/// @param of_amplitudes  nullptr: 0
/// @param modulus        nullptr: 1
void respond_back(const ResponseKnots& knots, const float* drive, size_t count, const float* of_cycles,
                  const float* of_amplitudes, const float* modulus, float factor, float* of_drive);

}  // namespace holotrace
