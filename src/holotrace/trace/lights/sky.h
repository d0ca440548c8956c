#pragma once

#include <array>

#include "holotrace/base/units.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/scene.h"
#include "holotrace/trace/shared/ray.h"

namespace holotrace {

/// Angular radius of the sun's disc [rad], half of 0.533°, and its solid angle [sr].
inline constexpr double sun_radius = 0.533 / 2 * pi / 180;
inline constexpr double sun_solid_angle = pi * sun_radius * sun_radius;

/// Radiance of a clear sky and of its sun at three wavelengths, of a nanometre of the spectrum [W/m²/sr].
///
/// **Sky.** Luminance Y and chromaticity x, y follow the direction by the formula of Perez,
///
///     F(θ, γ) = (1 + A·exp(B/cosθ))·(1 + C·exp(D·γ) + E·cos²γ),  Y = Y_z·F(θ, γ)/F(0, θ_s)
///
/// with θ the angle to the zenith, γ that to the sun and coefficients linear in the turbidity. The spectrum is that of daylight
/// of this chromaticity (data/cie.h), scaled to this luminance.
///
/// **Sun.** A disc of even radiance: Planck's law at 5778 K, times the transmittance of the air for Rayleigh scattering, haze and
/// ozone over the relative mass m of the air at that elevation (Kasten):
///
///     τ = exp(−m·(0.008735·λ^−4.08 + β·λ^−1.3 + 0.35 cm·k_o(λ))),  β = 0.04608·T − 0.04586,  λ in µm
///
/// Below the horizon, y < 0, there is no light. Wavelengths outside of the visible range (data/cie.h) are dark.
///
/// Reference: A. Preetham, P. Shirley, B. Smits, A Practical Analytic Model for Daylight, SIGGRAPH 1999; ozone: M. Iqbal, An
/// Introduction to Solar Radiation, 1983. Its sky is up to a third too bright or too dark within 10° of the horizon for
/// turbidities below 2 or above 6.
class SkyModel {
 public:
  SkyModel(const Sky& sky, const Lines& lines);

  /// Unit vector toward the sun.
  Vec3 sun_direction() const { return sun_; }
  /// Radiance of the disc; 0 without a sun.
  Vec3 sun_radiance() const { return sun_radiance_; }
  bool is_in_sun(Vec3 direction) const { return direction.y >= 0 && dot(direction, sun_) >= sun_cosine; }

  /// Radiance of the sky along a unit direction, without the disc.
  Vec3 sky_radiance(Vec3 direction) const;

 private:
  struct Perez {
    double a, b, c, d, e;
    double operator()(double cosine, double gamma, double cos_gamma) const;
  };
  static const double sun_cosine;

  Vec3 sun_, sun_radiance_;
  Perez luminance_, x_, y_;
  Vec3 zenith_;                // Y, x and y at the zenith, over the formula's value there
  std::array<Vec3, 3> parts_;  // S₀, S₁, S₂ at the lines
  Vec3 lumens_;                // luminance of the spectra S₀, S₁, S₂
};

}  // namespace holotrace
