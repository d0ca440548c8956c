#pragma once

#include "holotrace/base/vec.h"

namespace holotrace {

/// A smooth spectrum of reflectance, always between 0 and 1:
///
///     R(λ) = 1/2 + x/(2·√(1 + x²)),   x = c₀ + c₁·t + c₂·t²,   t = (λ − 580 nm)/200 nm
///
/// Reference: W. Jakob and J. Hanika, A Low-Dimensional Function Space for Efficient Spectral Upsampling, Computer Graphics Forum 38,
/// 2019. Outside of the visible range it stays as at its end.
struct SmoothReflectance {
  double c0 = 0, c1 = 0, c2 = 0;

  double at(double wavelength) const;  ///< [m]
  /// Linear red, green and blue of sRGB of the surface in daylight (D65), as the CIE 1931 standard observer sees it.
  Vec3 colour() const;
};

/// The spectrum whose colour is nearest to linear red, green and blue of sRGB, each in [0, 1]; they agree to 1e-3 for colours of all
/// surfaces but the most saturated. Solved by damped Gauss–Newton steps from grey.
/// Cost: 20 to 100 µs.
SmoothReflectance fit_reflectance(Vec3 rgb);

}  // namespace holotrace
