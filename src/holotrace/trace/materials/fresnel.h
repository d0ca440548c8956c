#pragma once

#include <algorithm>
#include <cmath>
#include <complex>

#include "holotrace/base/units.h"

// Reflection and refraction of a plane wave at a smooth boundary (Born & Wolf, Principles of Optics, 7th edition, 1999,
// sections 1.5 and 14.4). The time factor is exp(−iωt), so an index n + ik with k > 0 absorbs. `index` is the index of
// the far medium over that of the near one; `cosine` is the cosine of the angle of incidence, in [0, 1].
//
// The phase of scalar light. Vector waves have two reflection phases, of r_s and r_p; a scalar wave has one. The scalar
// boundary conditions, U and ∂U/∂n continuous, give
//
//     r = (k₁z − k₂z)/(k₁z + k₂z),
//
// which equals r_s. The phase here is therefore arg r_s: π off a denser medium at every angle (at grazing incidence
// too: Lloyd's mirror), 0 off a less dense one. At total reflection it is the Goos–Hänchen phase, continuous at the
// critical angle and π at grazing incidence. At Brewster's angle r_p changes its sign, without effect. Off dielectrics
// below the critical angle, the phase is also that of the mean of r_s and −r_p, since |r_p| ≤ |r_s|; with this sign the
// two amplitudes agree at normal incidence. The reflected power is that of unpolarised
// light, (|r_s|² + |r_p|²)/2.

namespace holotrace {

/// Amplitudes of the reflected and the transmitted wave over the incident one, with E perpendicular to the plane of
/// incidence (s) and in it (p; r_p = −r_s at normal incidence).
struct FresnelAmplitudes {
  std::complex<double> r_s, r_p, t_s, t_p;
};

/// q = √(index² − sin²θ): normal wave number in the far medium over the wave number in the near one. The wave decays
/// into the far medium: both parts are at least 0.
inline std::complex<double> far_normal_component(double cosine, std::complex<double> index) {
  const double n = index.real(), k = index.imag();
  const double real = n * n - k * k - (1 - cosine * cosine), imaginary = 2 * n * k;
  const double larger = std::sqrt(0.5 * (std::sqrt(real * real + imaginary * imaginary) + std::fabs(real)));
  if (larger == 0) return 0;
  const double smaller = imaginary / (2 * larger);  // avoids the cancellation of a difference
  return real > 0 ? std::complex<double>(larger, smaller) : std::complex<double>(smaller, larger);
}

/// Fresnel's amplitudes:
///
///     r_s = (c − q)/(c + q), r_p = (m²c − q)/(m²c + q), t_s = 2c/(c + q), t_p = 2mc/(m²c + q), c = cosθ, m = index.
inline FresnelAmplitudes fresnel_amplitudes(double cosine, std::complex<double> index) {
  const std::complex<double> q = far_normal_component(cosine, index), square = index * index;
  return {(cosine - q) / (cosine + q), (square * cosine - q) / (square * cosine + q), 2 * cosine / (cosine + q),
          2.0 * index * cosine / (square * cosine + q)};
}

/// Reflectance of unpolarised light at a boundary of dielectrics, in [0, 1]; 1 at total reflection.
inline double reflectance_dielectric(double cosine, double index) {
  const double q_squared = index * index - (1 - cosine * cosine);
  if (q_squared <= 0) return 1;
  const double q = std::sqrt(q_squared), square = index * index * cosine;
  if (square + q == 0) return 0;  // along the boundary of equal media
  const double r_s = (cosine - q) / (cosine + q), r_p = (square - q) / (square + q);
  return 0.5 * (r_s * r_s + r_p * r_p);
}

/// Reflectance of unpolarised light off a conductor, in [0, 1]: with q = a + ib,
///
///     R_s = ((c − a)² + b²)/((c + a)² + b²),
///     R_p = R_s·((a − s)² + b²)/((a + s)² + b²), s = sin²θ/cosθ.
inline double reflectance_conductor(double cosine, std::complex<double> index) {
  const std::complex<double> q = far_normal_component(cosine, index);
  const double c = cosine, a = q.real(), magnitude = a * a + q.imag() * q.imag(), sine_squared = 1 - c * c;
  const double sum_s = magnitude + c * c, mixed_s = 2 * a * c;
  if (sum_s + mixed_s == 0) return 0;
  const double r_s = (sum_s - mixed_s) / (sum_s + mixed_s);
  const double sum_p = magnitude * c * c + sine_squared * sine_squared, mixed_p = mixed_s * sine_squared;
  const double ratio = sum_p + mixed_p > 0 ? (sum_p - mixed_p) / (sum_p + mixed_p) : 1;
  return std::clamp(0.5 * r_s * (1 + ratio), 0.0, 1.0);
}

/// Phase that reflection adds to scalar light: arg r_s in (−π, π] [rad]. At total reflection
///
///     tan(δ/2) = −√(sin²θ − m²)/cosθ.
inline double reflection_phase(double cosine, std::complex<double> index) {
  const std::complex<double> q = far_normal_component(cosine, index);
  const double a = q.real(), b = q.imag();
  if (b == 0) return cosine < a ? pi : 0;
  return std::atan2(-2 * b * cosine, cosine * cosine - a * a - b * b);  // argument of (c − q)·(c + conj q)
}

/// Phase that transmission adds to scalar light: arg t_s [rad]; 0 between two dielectrics.
inline double transmission_phase(double cosine, std::complex<double> index) {
  return -std::arg(cosine + far_normal_component(cosine, index));
}

/// The index of a dielectric with that F₀ in air; F₀ of a perfect metal counts as slightly lower.
inline double index_of_f0(double f0) {
  const double r = std::sqrt(std::fmin(f0, 0.9999));
  return (1 + r) / (1 - r);
}

/// (1 − cosθ)⁵, the weight of white in Schlick's reflectance F₀ + (1 − F₀)(1 − cosθ)⁵ (Comput. Graph. Forum 13, 233,
/// 1994).
inline double schlick_weight(double cosine) {
  const double x = 1 - cosine, x2 = x * x;
  return x2 * x2 * x;
}

}  // namespace holotrace
