#pragma once

#include <complex>
#include <cstddef>

#include "holotrace/slm/encode/iterate/descent_kernel.h"

// The pixel loops of iterations, compiled for every instruction set. Sums use float lanes over the `count` samples of
// one call, which is a row; callers add the rows in double, in order.

namespace holotrace {

/// u ← u/|u|, and 1 where u is 0.
void make_unit_modulus(std::complex<float>* u, size_t count);

/// u ← (u + d)/|u + d|, and 1 where the sum is 0.
void add_and_make_unit_modulus(std::complex<float>* u, const std::complex<float>* d, size_t count);

/// power ← power + factor·|v|²
void add_power(const std::complex<float>* v, float factor, float* power, size_t count);

/// Sums that fit the amplitude A = √power to a target: Σw·a·A and Σw·A².
struct ModulusSums {
  double cross = 0, square = 0;
};

/// @param weight  w; nullptr means 1 everywhere
ModulusSums modulus_sums(const float* power, const float* amplitude, const float* weight, size_t count);

/// power ← w·(s·a − A)/A with A = √power, and 0 where A is 0: the factor that turns light of the amplitude A into the
/// change that gives it the amplitude s·a. @return Σw·(A − s·a)²
double take_residual(float* power, const float* amplitude, const float* weight, float scale, size_t count);

/// v ← factor·v
void multiply_by_real(const float* factor, std::complex<float>* v, size_t count);

/// d ← d + factor·Im(g·u*): adds the gradient by the phase of u, given g = ∂f/∂Re u + i·∂f/∂Im u.
void add_phase_gradient(const std::complex<float>* g, const std::complex<float>* u, float factor, float* d,
                        size_t count);

/// One step of Adam (Kingma and Ba, 2015): m ← β₁m + (1−β₁)d, v ← β₂v + (1−β₂)d², x ← x − step·m/(√v + ε). `step`
/// and ε include the bias corrections of the first steps.
using descent_kernel::AdamStep;
void adam_step(const AdamStep& adam, const float* d, float* m, float* v, float* x, size_t count);

/// Moves drives into their range and rounds them to levels. With `turn` > 0, the levels of a whole turn of phase, the
/// range is a circle: drive ← drive mod turn, and the level after the last is level 0. Otherwise it is [0, levels − 1].
/// With a hardness h < 1 the rounded values are soft: drive + h·(level − drive).
void settle_drive(float turn, float levels, float hardness, float* drive, float* rounded, size_t count);

}  // namespace holotrace
