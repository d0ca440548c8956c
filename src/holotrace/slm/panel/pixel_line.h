#pragma once

#include <complex>

#include "holotrace/base/array.h"
#include "holotrace/base/fft.h"

namespace holotrace {

/// From one row or column of pixels to the light that leaves it, on n samples per pixel. The lit part w of each pixel
/// is divided into s equal cells, each of one complex amplitude v:
///
///     û(f) = Σ_c [Σᵢ v(c, i)·exp(−2πi·f·i)]·(w/s)·sinc(w·f/s)·exp(−2πi·f·q_c),   q_c = w·((c + ½)/s − ½)
///
/// f is in cycles per pixel, limited to |f| ≤ n/2; n/2 itself gets the mean of both signs. The pixels' spectrum repeats
/// at every whole f, so s transforms of the pixels give all of it. A panel is computed along rows, then columns.
class PixelLine {
 public:
  /// @param pixels, samples_per_pixel, cells  length of the line [pixels], n and s, all ≥ 1
  /// @param lit    w, lit fraction of a pixel's side, in (0, 1]
  /// @param scale  factor on the light
  PixelLine(int pixels, int samples_per_pixel, int cells, double lit, double scale);

  int pixels() const { return pixels_; }
  int samples() const { return samples_; }
  int cells() const { return cells_; }
  /// The factors of the spectrum, [cell][sample frequency].
  const AlignedVector<std::complex<float>>& weights() const { return weights_; }

  /// @param cell  s × pixels values, [cell][pixel]; overwritten
  /// @param out   n·pixels samples; must not overlap `cell`
  void spread(std::complex<float>* cell, std::complex<float>* out) const;

  /// The adjoint of spread: Σ conj(out)·spread(cell) = Σ conj(gather(out))·cell. `out` is overwritten.
  void gather(std::complex<float>* out, std::complex<float>* cell) const;

 private:
  int pixels_, samples_, cells_;
  Fft<float> pixels_forward_, pixels_backward_, samples_forward_, samples_backward_;
  AlignedVector<std::complex<float>> weights_, conjugate_weights_;  // [cell][sample frequency]
};

}  // namespace holotrace
