#pragma once

#include <complex>

#include "holotrace/base/array.h"
#include "holotrace/base/fft.h"

namespace holotrace {

/// One row or column of pixels → the light that leaves it, on n samples per pixel. The lit part w of each pixel is cut
/// into s equal cells, each of one complex amplitude v:
///
///     û(f) = Σ_c [Σᵢ v(c, i)·exp(−2πi·f·i)]·(w/s)·sinc(w·f/s)·exp(−2πi·f·q_c),   q_c = w·((c + ½)/s − ½)
///
/// f in cycles per pixel, cut to |f| ≤ n/2, where n/2 itself takes the mean of both signs. The pixels' spectrum repeats
/// at every whole f: s transforms of the pixels make all of it. A panel is rows, then columns.
class PixelLine {
 public:
  /// @param pixels, samples_per_pixel, cells  of the line, n and s, all ≥ 1
  /// @param lit    w, part of a pixel's side that is lit, in (0, 1]
  /// @param scale  factor on the light
  PixelLine(int pixels, int samples_per_pixel, int cells, double lit, double scale);

  int pixels() const { return pixels_; }
  int samples() const { return samples_; }
  int cells() const { return cells_; }

  /// @param cell  s × pixels values, [cell][pixel]; overwritten
  /// @param out   n·pixels samples; does not overlap with `cell`
  void spread(std::complex<float>* cell, std::complex<float>* out) const;

  /// The adjoint of spread: Σ conj(out)·spread(cell) = Σ conj(gather(out))·cell. `out` is overwritten.
  void gather(std::complex<float>* out, std::complex<float>* cell) const;

 private:
  int pixels_, samples_, cells_;
  Fft<float> pixels_forward_, pixels_backward_, samples_forward_, samples_backward_;
  AlignedVector<std::complex<float>> weights_, conjugate_weights_;  // [cell][sample frequency]
};

}  // namespace holotrace
