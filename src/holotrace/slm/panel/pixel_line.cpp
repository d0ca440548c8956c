#include "holotrace/slm/panel/pixel_line.h"

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/frequency.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/panel/pixel_kernel.h"

namespace holotrace {

PixelLine::PixelLine(int pixels, int samples_per_pixel, int cells, double lit, double scale)
    : pixels_(pixels),
      samples_(pixels * samples_per_pixel),
      cells_(cells),
      pixels_forward_(pixels, FftDirection::forward),
      pixels_backward_(pixels, FftDirection::backward),
      samples_forward_(samples_, FftDirection::forward),
      samples_backward_(samples_, FftDirection::backward),
      weights_(size_t(cells) * size_t(samples_)),
      conjugate_weights_(weights_.size()) {
  for (int c = 0; c < cells; ++c) {
    const double place = lit * ((c + 0.5) / cells - 0.5);
    for (int k = 0; k < samples_; ++k) {
      const int f = signed_frequency(k, samples_);
      // Sample t of the line lies (t − (n−1)/2)/n pixels from the centre of pixel 0.
      const double angle = -pi * f * (samples_per_pixel - 1.0) / samples_ - 2 * pi * f * place / pixels;
      std::complex<double> weight = aperture_spectrum(double(f) / pixels, lit / cells) * std::polar(1.0, angle);
      if (2 * f == -samples_) weight = weight.real();  // the mean of both signs of n/2
      const size_t at = size_t(c) * size_t(samples_) + size_t(k);
      weights_[at] = std::complex<float>(weight * scale / double(pixels));
      conjugate_weights_[at] = std::conj(weights_[at]);
    }
  }
}

void PixelLine::spread(std::complex<float>* cell, std::complex<float>* out) const {
  const size_t length = size_t(pixels_), samples = size_t(samples_);
  for (size_t c = 0; c < size_t(cells_); ++c) {
    std::complex<float>* line = cell + c * length;
    pixels_forward_(line);
    for (size_t k = 0; k < samples; k += length) {
      const std::complex<float>* weight = weights_.data() + c * samples + k;
      if (c == 0)
        multiply(out + k, line, weight, length);
      else
        multiply_add(out + k, line, weight, length);
    }
  }
  samples_backward_(out);
}

void PixelLine::gather(std::complex<float>* out, std::complex<float>* cell) const {
  const size_t length = size_t(pixels_), samples = size_t(samples_);
  samples_forward_(out);
  for (size_t c = 0; c < size_t(cells_); ++c) {
    std::complex<float>* line = cell + c * length;
    for (size_t k = 0; k < samples; k += length) {
      const std::complex<float>* weight = conjugate_weights_.data() + c * samples + k;
      if (k == 0)
        multiply(line, out, weight, length);
      else
        multiply_add(line, out + k, weight, length);
    }
    pixels_backward_(line);
  }
}

}  // namespace holotrace
