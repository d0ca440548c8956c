#pragma once

#include <array>
#include <cmath>
#include <complex>

#include "holotrace/base/units.h"

namespace holotrace {

/// A film of index n_f and thickness d between air and a base of index n_b, at one wavelength λ. The waves that are reflected
/// between its two faces interfere (Airy's sum; Born & Wolf, Principles of Optics, 7th edition, 1.6.4 and 7.6.1):
///
///     r = (r₁₂ + r₂₃·e^{iδ})/(1 + r₁₂·r₂₃·e^{iδ}),   δ = 4π·n_f·d·cosθ_f/λ.
///
/// It is exact for smooth faces and light of one wavelength. Indices are real and at least 1.
struct ThinFilm {
  double film_index = 1, base_index = 1;
  double order = 0;  ///< n_f·d/λ, optical thickness in waves

  /// Reflection amplitudes at the two faces, of one polarisation.
  struct Faces {
    double outer, inner;
  };
  struct Both {
    Faces s, p;
    double delta;  ///< δ [rad]
  };

  /// @param cosine  of the angle of incidence, in [0, 1]
  Both faces(double cosine) const {
    const double sine_squared = 1 - cosine * cosine, c = cosine, n = film_index, b = base_index;
    const double cf = std::sqrt(std::fmax(0, 1 - sine_squared / (n * n)));
    const double cb = std::sqrt(std::fmax(0, 1 - sine_squared / (b * b)));
    const auto ratio = [](double from, double to) { return from + to > 0 ? (from - to) / (from + to) : 0; };
    return {{ratio(c, n * cf), ratio(n * cf, b * cb)}, {ratio(n * c, cf), ratio(b * cf, n * cb)}, 4 * pi * order * cf};
  }
};

/// Reflectance of unpolarised light, (|r_s|² + |r_p|²)/2, in [0, 1].
inline double reflectance_film(double cosine, const ThinFilm& film) {
  const auto [s, p, delta] = film.faces(cosine);
  const auto reflected = [interference = 2 * std::cos(delta)](ThinFilm::Faces r) {
    const double product = r.outer * r.inner, sum = 1 + product * product + interference * product;
    return sum > 0 ? (r.outer * r.outer + r.inner * r.inner + interference * product) / sum : 0;
  };
  return 0.5 * (reflected(s) + reflected(p));
}

/// Phase that the film adds to reflected scalar light, arg r_s in (−π, π] [rad] (fresnel.h).
inline double reflection_phase_film(double cosine, const ThinFilm& film) {
  const auto [s, p, delta] = film.faces(cosine);
  const std::complex<double> turn = std::polar(1.0, delta);
  return std::arg((s.outer + s.inner * turn) * (1.0 + s.outer * s.inner * std::conj(turn)));
}

}  // namespace holotrace
