#pragma once

#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/column_fft.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/large_buffer.h"
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

/// From one row or column of pixels to the light that leaves it, on n samples per pixel. The light over the lit part w of
/// each pixel is a sum of Legendre polynomials, Σ_k v(k, i)·P_k(2q/w) at q from the centre of pixel i (PixelExpansion):
///
///     û(f) = Σ_k [Σᵢ v(k, i)·exp(−2πi·f·i)]·w·(−i)ᵏ·j_k(π·w·f),   j₀(πx) = sinc(x)
///
/// f is in cycles per pixel, limited to |f| ≤ n/2; n/2 itself gets the mean of both signs. The pixels' spectrum repeats
/// at every whole f, so one transform of the pixels per term gives all of it. A panel is computed along rows, then columns.
class PixelLine {
 public:
  /// @param pixels, samples_per_pixel, terms  length of the line [pixels], n and number of polynomials, all ≥ 1
  /// @param lit    w, lit fraction of a pixel's side, in (0, 1]
  /// @param scale  factor on the light
  PixelLine(int pixels, int samples_per_pixel, int terms, double lit, double scale);

  int pixels() const { return pixels_; }
  int samples() const { return samples_; }
  /// The factors of the spectrum, [term][sample frequency].
  const AlignedVector<std::complex<float>>& weights() const { return weights_; }

  /// Light of one row.
  ///
  /// @param count  number of terms that are given: the first ones
  /// @param terms  count × pixels values, [term][pixel]
  /// @param out    n·pixels samples
  void spread(int count, const std::complex<float>* terms, std::complex<float>* out) const;

  /// The adjoint of spread: Σ conj(out)·spread(terms) = Σ conj(gather(out))·terms.
  void gather(int count, const std::complex<float>* out, std::complex<float>* terms) const;

  /// The same for a block of columns, which are side by side: [term][pixel][column] and [sample][column], aligned to 64
  /// bytes.
  void spread_block(int count, const std::complex<float>* terms, std::complex<float>* out) const;
  void gather_block(int count, const std::complex<float>* out, std::complex<float>* terms) const;

  static constexpr int block = column_block;

 private:
  int pixels_, samples_;
  Fft<float> pixels_forward_, pixels_backward_, samples_forward_, samples_backward_;  // of a row
  ColumnFft<float> pixels_of_block_, samples_of_block_;
  AlignedVector<std::complex<float>> weights_, conjugates_;  // [term][sample frequency]
  mutable Workspace workspace_;
};

}  // namespace holotrace
