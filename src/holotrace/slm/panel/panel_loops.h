#pragma once

#include <array>
#include <complex>
#include <cstddef>

namespace holotrace {

/// to[i] = amplitude[i]·exp(2πi·cycles[i]) for |cycles| < 2²¹, within 2e-7 of the amplitude plus the rounding of the
/// cycles; compiled for every instruction set. Without amplitudes (nullptr) they are 1.
void phasors(const float* cycles, const float* amplitude, size_t count, std::complex<float>* to);

// Loops over the drives of one row of pixels with a calibration (PixelResponse), compiled for every instruction set.

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

// Loops of a panel with crosstalk and of its gradients over the pixels of one row, compiled for every instruction set.

/// to[i] = Σ_d factors[d]·from[i + d] over `taps` factors, or += that; from has count + taps − 1 values.
void blur_line(const float* from, const float* factors, size_t taps, size_t count, bool adds, float* to);

/// to[i] = Σ_r factors[r]·lines[r][i].
void sum_lines(const float* const* lines, const float* factors, size_t number, size_t count, float* to);

/// The gradient by phase [cycles] and amplitude a of light a·u, u of modulus 1, from q = ∂f/∂(a·u):
///
///     of_cycles = 2π·a·Im(q·u*),   of_amplitudes = Re(q·u*)
///
/// @param amplitude      a; nullptr means 1
/// @param of_amplitudes  nullptr: not wanted
void turn_back(const std::complex<float>* q, const std::complex<float>* u, const float* amplitude, size_t count,
               float* of_cycles, float* of_amplitudes);

}  // namespace holotrace
