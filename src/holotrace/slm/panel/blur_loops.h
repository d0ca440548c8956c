#pragma once

#include <complex>
#include <cstddef>

// Loops of a panel with crosstalk and of its gradients over the pixels of one row, compiled for every instruction set.

namespace holotrace {

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
