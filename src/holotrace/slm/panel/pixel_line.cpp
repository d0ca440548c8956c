#include "holotrace/slm/panel/pixel_line.h"

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/frequency.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/panel/pixel_expansion.h"

namespace holotrace {

using Complex = std::complex<float>;

PixelLine::PixelLine(int pixels, int samples_per_pixel, int terms, double lit, double scale)
    : pixels_(pixels),
      samples_(pixels * samples_per_pixel),
      of_row_(pixels, samples_, 1),
      of_block_(pixels, samples_, block),
      weights_(size_t(terms) * size_t(samples_)) {
  const auto turned = [](double value, int term) {  // value·(−i)ᵏ
    const double signed_value = term % 4 < 2 ? value : -value;
    return term % 2 == 0 ? std::complex<double>(signed_value) : std::complex<double>(0, -signed_value);
  };
  for (int term = 0; term < terms; ++term)
    for (int k = 0; k < samples_; ++k) {
      const double f = double(signed_frequency(k, samples_)) / pixels;
      // Sample t of the line lies (t − (n−1)/2)/n pixels from the centre of pixel 0.
      const double shift = -pi * f * (samples_per_pixel - 1.0) / samples_per_pixel;
      std::complex<double> weight = turned(lit * legendre_spectrum(term, pi * lit * f), term) * std::polar(1.0, shift);
      if (2 * signed_frequency(k, samples_) == -samples_) weight = weight.real();  // the mean of both signs of n/2
      weights_[size_t(term) * size_t(samples_) + size_t(k)] = std::complex<float>(weight * scale / double(pixels));
    }
}

// The lines are side by side; their spectra are one after the other.
PixelLine::Transforms::Transforms(int pixels, int samples, int lines)
    : lines(lines),
      pixels_forward(pixels, {lines, lines, 1, 1, pixels}, FftDirection::forward),
      pixels_backward(pixels, {lines, 1, pixels, lines, 1}, FftDirection::backward),
      samples_forward(samples, {lines, lines, 1, 1, samples}, FftDirection::forward),
      samples_backward(samples, {lines, 1, samples, lines, 1}, FftDirection::backward) {}

void PixelLine::spread(const Transforms& transforms, int count, const Complex* terms, Complex* out) const {
  const size_t length = size_t(pixels_), samples = size_t(samples_), lines = size_t(transforms.lines);
  Workspace::Loan space(workspace_, 2 * lines * (length + samples));
  Complex *of_samples = reinterpret_cast<Complex*>(space.data()), *of_pixels = of_samples + lines * samples;
  for (size_t c = 0; c < size_t(count); ++c) {
    transforms.pixels_forward(terms + c * lines * length, of_pixels);
    for (size_t line = 0; line < lines; ++line)
      for (size_t k = 0; k < samples; k += length) {
        const Complex *from = of_pixels + line * length, *weight = weights_.data() + c * samples + k;
        Complex* to = of_samples + line * samples + k;
        if (c == 0)
          multiply(to, from, weight, length);
        else
          multiply_add(to, from, weight, length);
      }
  }
  transforms.samples_backward(of_samples, out);
}

void PixelLine::gather(const Transforms& transforms, int count, const Complex* out, Complex* terms) const {
  const size_t length = size_t(pixels_), samples = size_t(samples_), lines = size_t(transforms.lines);
  Workspace::Loan space(workspace_, 2 * lines * (length + samples));
  Complex *of_samples = reinterpret_cast<Complex*>(space.data()), *of_pixels = of_samples + lines * samples;
  transforms.samples_forward(out, of_samples);
  for (size_t c = 0; c < size_t(count); ++c) {
    for (size_t line = 0; line < lines; ++line)
      for (size_t k = 0; k < samples; k += length) {
        const Complex *from = of_samples + line * samples + k, *weight = weights_.data() + c * samples + k;
        Complex* to = of_pixels + line * length;
        if (k == 0)
          multiply_conjugate(to, from, weight, length);
        else
          multiply_conjugate_add(to, from, weight, length);
      }
    transforms.pixels_backward(of_pixels, terms + c * lines * length);
  }
}

void PixelLine::spread(int count, const Complex* terms, Complex* out) const { spread(of_row_, count, terms, out); }
void PixelLine::gather(int count, const Complex* out, Complex* terms) const { gather(of_row_, count, out, terms); }

void PixelLine::spread_block(int count, const Complex* terms, Complex* out) const {
  spread(of_block_, count, terms, out);
}

void PixelLine::gather_block(int count, const Complex* out, Complex* terms) const {
  gather(of_block_, count, out, terms);
}

}  // namespace holotrace
