#pragma once

#include <complex>
#include <cstddef>

namespace holotrace {

/// Largest |U|, sum of |U| and sum of |U|². The brightness of a hologram follows from them.
struct ModulusMoments {
  double largest = 0, sum = 0, square = 0;
};

// Loops over samples in vector lanes, for the encoders of one pass.

/// The moments of `count` samples, in double.
ModulusMoments modulus_moments(const std::complex<float>* u, size_t count);

/// The phase of each sample (of its conjugate for sign = −1) in turns, in [0, 1], within 1e-7; 0 for a sample of 0.
void phases_of(const std::complex<float>* u, float sign, size_t count, float* turns);

/// What the pixels of a double-phase hologram show for samples of modulus a ≤ 1: exp(i·arg U)·(a ± i√(1 − a²)), with the
/// sign of `first` (1 or −1) for the first sample, and then in turn. The phase of a sample below 1e-22 counts as 0.
void double_phase_phasors(const std::complex<float>* u, float first, size_t count, std::complex<float>* to);

}  // namespace holotrace
