#pragma once

#include <vector>

#include "holotrace/data/params/show.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// The light over the lit part w of a pixel as a sum of products of Legendre polynomials P_p(2x/w)·P_q(2y/w) with
/// p + q < terms. Their factors follow from the light at points × points places. Only low frequencies, |f| ≤ n/2 cycles per
/// pixel, are needed, where the spectrum of P_k is small for large k, so few terms are enough. The error falls exponentially
/// with both numbers.
///
/// Without crosstalk the light over a pixel is even: one point, one term.
struct PixelExpansion {
  int points = 1;  ///< along each axis, those of Gauss–Legendre quadrature
  int terms = 1;   ///< along each axis, at most as many as points

  /// Number of pairs (p, q).
  int pairs() const { return terms * (terms + 1) / 2; }
};

/// How exactly the light over a pixel is expanded.
enum class PixelDetail {
  as_shown,  ///< as `show` takes it
  coarse,    ///< about half of the time of that
  mean       ///< the mean over the pixel: for slopes only
};

/// The expansion of the light for n samples per pixel. Without crosstalk it is one point and one term.
///
/// - as_shown: params.fine_samples points; if that is 0, n + 2, but at least 4, or 8 for σ below 0.2
///   pixels, and at most 64. There are n + 2 terms, but not more than points. For random phases and σ = 0.2 the error of the
///   light is −43 dB for n = 1 and −35 dB for n = 3 (docs/explanation/slm.md).
/// - coarse: n + 1 terms on fewer points. For n = 1 the error is −26 dB.
/// - mean: the mean of 2 × 2 points, one term.
PixelExpansion pixel_expansion(const Slm& slm, const ShowParams& params, PixelDetail detail = PixelDetail::as_shown);

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
