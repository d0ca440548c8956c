#pragma once

#include <vector>

#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// The light over the lit part w of a pixel as a sum of products of Legendre polynomials P_p(2x/w)·P_q(2y/w) with
/// p + q < terms, from its values at points × points places. Only low frequencies, |f| ≤ n/2 cycles per pixel, are wanted
/// of it, and the spectrum of P_k hardly reaches them for large k: few terms are enough, where cells of one
/// amplitude each would have to be many. The error falls exponentially with both numbers.
///
/// Without crosstalk the light over a pixel is even: one point, one term.
struct PixelExpansion {
  int points = 1;  ///< along each axis, those of Gauss–Legendre quadrature
  int terms = 1;   ///< along each axis, at most as many as points

  /// Number of pairs (p, q).
  int pairs() const { return terms * (terms + 1) / 2; }
};

/// What `show` takes. With crosstalk, params.fine_samples points; if that is 0, n + 2 for n samples per pixel, and at
/// least 4, or 8 for σ below 0.2 pixels, and at most 64. n + 2 terms, if there are so many points: for random phases and σ = 0.2, the light is exact to −43 dB for n = 1
/// and −35 dB for n = 3 (docs/explanation/slm.md).
PixelExpansion pixel_expansion(const Slm& slm, const ShowParams& params);

/// Less, for iterations that need not be exact: n + 1 terms, which are exact to −26 dB for n = 1 at a third of the work.
PixelExpansion coarse_pixel_expansion(const Slm& slm, const ShowParams& params);

/// Places and projections of an expansion along one axis.
struct LegendrePoints {
  /// @param count  number of points, ≥ 1
  /// @param terms  from 1 to count
  LegendrePoints(int count, int terms);

  std::vector<double> places;      ///< t in (−1, 1), rising
  std::vector<float> projections;  ///< [term][point]: Σ_c projection(k, c)·v(t_c) is the factor of P_k in v
};

/// ½∫P_k(t)·exp(−iat)dt over [−1, 1], without its factor (−i)ᵏ: the spherical Bessel function j_k(a).
double legendre_spectrum(int term, double a);

}  // namespace holotrace
