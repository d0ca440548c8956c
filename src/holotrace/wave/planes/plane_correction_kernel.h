#pragma once

// The part of a wave in a tile beyond a plane wave times a curvature (summation.h), in the common language of C++ and
// OpenCL C. The tiles are corrected by it (plane_tile.cpp; on devices plane_sum.cl), and the error of the correction is
// measured with it (plane_plan.cpp).

#ifdef __OPENCL_VERSION__
#define HOLOTRACE_OF_REAL
#define HOLOTRACE_CORRECTION struct Correction
#define HOLOTRACE_TERMS struct CorrectionTerms
#define HOLOTRACE_COMPLEX float2
typedef float Real;
float2 complex_of(float re, float im) { return (float2)(re, im); }
float2 product(float2 a, float2 b) { return (float2)(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }
float2 times_i(float2 z) { return (float2)(-z.y, z.x); }
#else
#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/units.h"

#define HOLOTRACE_OF_REAL template <class Real>
#define HOLOTRACE_CORRECTION Correction<Real>
#define HOLOTRACE_TERMS CorrectionTerms<Real>
#define HOLOTRACE_COMPLEX std::complex<Real>
namespace holotrace {
template <class Real>
std::complex<Real> complex_of(Real re, Real im) {
  return {re, im};
}
#endif

/// First-order expansion of exp(2πi(r − r₀)/λ)·r₀/r, without the plane wave and its curvature. With the
/// frequency (f, g) = (x, y)/λr₀ its terms are the second-order phase −2πλ/r₀·(f·g·u·v + (f² − g²)(u² − v²)/4), the
/// modulus −λ/r₀·(f·u + g·v), and the third-order phase −π/r₀²·(f·u + g·v)(u² + v² − linear).
HOLOTRACE_OF_REAL struct Correction {
  Real second, first, third;  // −2πλ/r₀, −λ/r₀, −π/r₀²
  Real linear;                // c·h², the linear part that was added to the frequency [m²]
};

/// A wave, or a sum of waves, times functions of its frequency: f, g, f·g, f² − g².
HOLOTRACE_OF_REAL struct CorrectionTerms { HOLOTRACE_COMPLEX f, g, cross, difference; };

/// The correction to add to the wave at (u, v) from the tile's reference pixel [m].
HOLOTRACE_OF_REAL HOLOTRACE_COMPLEX correction_at(HOLOTRACE_CORRECTION c, HOLOTRACE_TERMS terms, Real u, Real v) {
  const Real cubic = c.third * (u * u + v * v - c.linear);
  return times_i(c.second * (u * v * terms.cross + (Real)0.25f * (u * u - v * v) * terms.difference)) +
         product(complex_of(c.first, cubic), u * terms.f + v * terms.g);
}

/// The terms of the waves from those of the cells that they are spread over: cells are weighted by their own
/// frequencies, and the kernel's moments tell how far they lie from the waves'.
/// @param sum       the waves without weights
/// @param first_u, first_v, second_u, second_v  the moments ∫xⁿφ·exp(2πiξx)dx/φ̂ at u and at v [cycles/m, cycles²/m²]
HOLOTRACE_OF_REAL HOLOTRACE_TERMS terms_of_waves(HOLOTRACE_TERMS cells, HOLOTRACE_COMPLEX sum, Real first_u,
                                                 Real first_v, Real second_u, Real second_v) {
  HOLOTRACE_TERMS waves;
  waves.f = cells.f - times_i(first_u * sum);
  waves.g = cells.g - times_i(first_v * sum);
  waves.cross = cells.cross - times_i(first_u * waves.g + first_v * waves.f) + first_u * first_v * sum;
  waves.difference =
      cells.difference - (Real)2 * times_i(first_u * waves.f - first_v * waves.g) - (second_u - second_v) * sum;
  return waves;
}

#ifndef __OPENCL_VERSION__

/// The part of u·(u² + v²) that is linear in u, by least squares over a tile |u|, |v| ≤ h. It is c·h²·u with
///
///     c = ⟨u²(u² + v²)⟩/⟨u²⟩/h² = (⟨u⁴⟩/⟨u²⟩ + ⟨v²⟩)/h² = 3/5 + 1/3
///
/// The third-order phase has such a part. It is added to the frequency, which leaves less phase to correct.
inline constexpr double linear_of_cubic = 0.6 + 1.0 / 3;

/// The same along one axis alone, for u³ over |u| ≤ h: ⟨u⁴⟩/⟨u²⟩/h² = 3/5.
inline constexpr double linear_of_cube = 0.6;

/// @param per_r0  1/r₀ [1/m]
template <class Real>
Correction<Real> correction_for(double wavelength, double per_r0, double linear) {
  return {Real(-2 * pi * wavelength * per_r0), Real(-wavelength * per_r0), Real(-pi * per_r0 * per_r0), Real(linear)};
}

}  // namespace holotrace
#endif
#undef HOLOTRACE_OF_REAL
#undef HOLOTRACE_CORRECTION
#undef HOLOTRACE_TERMS
#undef HOLOTRACE_COMPLEX
