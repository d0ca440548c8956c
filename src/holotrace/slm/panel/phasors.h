#pragma once

#include <complex>
#include <cstddef>

namespace holotrace {

/// to[i] = amplitude[i]·exp(2πi·cycles[i]) for |cycles| < 2²¹, within 2e-7 of the amplitude plus the rounding of the
/// cycles; compiled for every instruction set. Without amplitudes (nullptr) they are 1.
void phasors(const float* cycles, const float* amplitude, size_t count, std::complex<float>* to);

}  // namespace holotrace
