#pragma once

#include <cmath>
#include <complex>

#include "holotrace/base/units.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"

namespace holotrace {

/// Transfer function of free space over z [m] at the spatial frequency (u, v) [1/m]:
///
///     H = exp(i2πz·√(λ⁻² − u² − v²));   evanescent waves decay with |z|, for either sign of z
///
/// @param start_cycles  cycle_fraction(z, λ): the axial phase, reduced once
inline std::complex<double> angular_spectrum_transfer(double u, double v, double wavelength, double z,
                                                      double start_cycles) {
  const double q = u * u + v * v, k = 1 / wavelength, kz2 = k * k - q;
  if (kz2 < 0) return std::exp(-2 * pi * std::abs(z) * std::sqrt(-kz2));
  return cis_cycles(start_cycles - z * q / (k + std::sqrt(kz2)));  // z·kz − z·k without cancellation
}

/// First Rayleigh–Sommerfeld kernel, the Kirchhoff kernel of the paper, at the offset ρ² = x² + y²:
///
///     h = (1/2π)·(z/r²)·(1/r − ik)·exp(ikr);   z < 0 takes the conjugate of h at −z, back-propagation
///
/// @param start_cycles  cycle_fraction(|z|, λ)
inline std::complex<double> rayleigh_sommerfeld_kernel(double rho2, double wavelength, double z, double start_cycles) {
  const double depth = std::abs(z), beyond = path_beyond_depth(rho2, depth), r = depth + beyond;
  const double k = 2 * pi / wavelength;
  const std::complex<double> h =
      depth / (2 * pi * r * r) * std::complex<double>(1 / r, -k) * cis_cycles(start_cycles + beyond / wavelength);
  return z < 0 ? std::conj(h) : h;
}

/// Distance z* = S·√((2p/λ)² − 1), S the largest offset between the windows. Up to z* the padded angular spectrum
/// represents the whole Nyquist band of the pitch p; from z* on the Rayleigh–Sommerfeld kernel does.
inline double critical_distance(double offset, double wavelength, double pitch) {
  const double ratio = 2 * pitch / wavelength;
  return ratio > 1 ? offset * std::sqrt(ratio * ratio - 1) : 0;
}

}  // namespace holotrace
