#pragma once

#include "holotrace/base/complex_product.h"
#include "holotrace/base/units.h"

// The part of a wave in a tile beyond a plane wave times a curvature (sum_planes.h). The tiles are corrected by it
// (plane_tile.cpp), and the error of the correction is measured with it (plane_error.cpp).

namespace holotrace {

/// The part of u·(u² + v²) that is linear in u, by least squares over a tile |u|, |v| ≤ h. It is c·h²·u with
///
///     c = ⟨u²(u² + v²)⟩/⟨u²⟩/h² = (⟨u⁴⟩/⟨u²⟩ + ⟨v²⟩)/h² = 3/5 + 1/3
///
/// The third-order phase has such a part. It is added to the frequency, which leaves less phase to correct.
inline constexpr double linear_of_cubic = 0.6 + 1.0 / 3;

/// The same along one axis alone, for u³ over |u| ≤ h: ⟨u⁴⟩/⟨u²⟩/h² = 3/5.
inline constexpr double linear_of_cube = 0.6;

/// First-order expansion of exp(2πi(r − r₀)/λ)·r₀/r, without the plane wave and its curvature. With the
/// frequency (f, g) = (x, y)/λr₀ its terms are the second-order phase −2πλ/r₀·(f·g·u·v + (f² − g²)(u² − v²)/4), the
/// modulus −λ/r₀·(f·u + g·v), and the third-order phase −π/r₀²·(f·u + g·v)(u² + v² − linear).
template <class Real>
struct Correction {
  Real second, first, third, linear;

  /// @param per_r0  1/r₀ [1/m]
  /// @param linear  c·h², the linear part that was added to the frequency [m²]
  Correction(double wavelength, double per_r0, double linear)
      : second(Real(-2 * pi * wavelength * per_r0)),
        first(Real(-wavelength * per_r0)),
        third(Real(-pi * per_r0 * per_r0)),
        linear(Real(linear)) {}

  /// A wave, or a sum of waves, times functions of its frequency.
  struct Terms {
    std::complex<Real> f, g, cross, difference;  ///< f, g, f·g, f² − g²
  };

  /// The correction to add to the wave at (u, v) from the tile's reference pixel [m].
  std::complex<Real> of(const Terms& terms, Real u, Real v) const {
    const Real cubic = third * (u * u + v * v - linear);
    return times_i(second * (u * v * terms.cross + Real(0.25) * (u * u - v * v) * terms.difference)) +
           product(std::complex<Real>(first, cubic), u * terms.f + v * terms.g);
  }
};

}  // namespace holotrace
