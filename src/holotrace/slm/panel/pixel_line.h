#pragma once

#include <complex>

#include "holotrace/base/array.h"
#include "holotrace/base/column_fft.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/workspace.h"

namespace holotrace {

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
  FftBatch<float> pixels_forward_, pixels_backward_, samples_forward_, samples_backward_;  // of a row
  ColumnFft<float> pixels_of_block_, samples_of_block_;
  AlignedVector<std::complex<float>> weights_, conjugates_;  // [term][sample frequency]
  mutable Workspace workspace_;
};

}  // namespace holotrace
