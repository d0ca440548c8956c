#pragma once

#include <cmath>

// The Fourier transform of a triangle in closed form. Over the simplex t₀ + t₁ + t₂ = 1, tᵢ ≥ 0, with a phase that is
// linear between the corners (θ₀, θ₁, θ₂), the formula of Hermite and Genocchi says
//
//     ∬ exp(i·Σ tⱼθⱼ) dt = exp[iθ₀, iθ₁, iθ₂],
//
// the divided difference of exp; a factor tⱼ repeats the node iθⱼ. (C. de Boor, Divided differences, Surveys in
// Approximation Theory 1, 2005.) A divided difference over nodes whose outer two are G apart is the difference of two
// over one node less, divided by iG; where G is small it is the Taylor series
//
//     exp[x₀ … xₙ] = exp(m)·Σₖ hₖ(x₀ − m, …, xₙ − m)/(k + n)!,   hₖ the complete homogeneous polynomials.
//
// Written once, for double and for vectors of floats. `Real` has + − · / with itself, `real(x, c)` makes a constant,
// `cis_of(angle, re, im)` makes the unit phasor, and `small_or(h2, small, large)` selects `small` per lane where
// h2 < 0.5. The formulas are in a separate file because the vector code is compiled once for each instruction set.

namespace holotrace {

inline double real(double, double value) { return value; }
inline void cis_of(double angle, double& re, double& im) {
  re = std::cos(angle);
  im = std::sin(angle);
}
inline double small_or(double h2, double small, double large) { return h2 < 0.5 ? small : large; }

#include "holotrace/wave/triangles/triangle_moments_formulas.h"

/// Order of the corners such that the phases of the first and the last differ most; `gap` is that difference [rad].
struct CornerOrder {
  int first, middle, last;
  double gap;
};
inline CornerOrder order_corners(const double phase[3]) {
  const double g01 = std::abs(phase[0] - phase[1]), g12 = std::abs(phase[1] - phase[2]),
               g02 = std::abs(phase[0] - phase[2]);
  if (g01 >= g12 && g01 >= g02) return {0, 2, 1, g01};
  if (g12 >= g02) return {1, 0, 2, g12};
  return {0, 1, 2, g02};
}

/// Moments of the corners in the order given, in double. Absolute error: 1e-14 of their values at equal phases.
inline TriangleMoments<double> triangle_moments(double first, double middle, double last) {
  return std::abs(first - last) < 1.5 ? moments_by_series<18>(first, middle, last)
                                      : moments_by_quotients(first, middle, last);
}

}  // namespace holotrace
