#include "holotrace/slm/panel/pixel_expansion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/units.h"

namespace holotrace {
namespace {

constexpr int most_points = 64;

// P_n and its derivative at |t| < 1.
struct LegendreValue {
  double value, slope;
};

LegendreValue legendre(int n, double t) {
  const unsigned order = unsigned(n);
  const double value = std::legendre(order, t);
  return {value, n * (std::legendre(order - 1, t) - t * value) / (1 - t * t)};
}

}  // namespace

PixelExpansion pixel_expansion(const Slm& slm, const ShowParams& params, PixelDetail detail) {
  if (!(slm.effects.crosstalk > 0)) return {};
  if (detail == PixelDetail::mean) return {2, 1};
  const int wanted = std::clamp(params.subpixels, 0, most_points) + 2, least = slm.effects.crosstalk < 0.2 ? 8 : 4;
  const int points = params.fine_samples > 0 ? params.fine_samples : std::clamp(wanted, least, most_points);
  if (detail == PixelDetail::as_shown) return {points, std::min(points, wanted)};
  const int terms = std::min(points, wanted - 1);
  return {std::max(terms, points / 2), terms};
}

LegendrePoints::LegendrePoints(int count, int terms) {
  for (int c = 0; c < count; ++c) {
    double t = -std::cos(pi * (c + 0.75) / (count + 0.5));  // Newton's method from here finds each zero of P_count
    for (int i = 0; i < 20; ++i) {
      const LegendreValue p = legendre(count, t);
      t -= p.value / p.slope;
    }
    places.push_back(2 * c + 1 == count ? 0 : t);
  }
  for (int k = 0; k < terms; ++k)
    for (const double t : places) {
      const double slope = legendre(count, t).slope, weight = 2 / ((1 - t * t) * slope * slope);
      projections.push_back(float((k + 0.5) * weight * std::legendre(unsigned(k), t)));
    }
}

// Upwards from sin(a)/a where that is stable.
double legendre_spectrum(int term, double a) {
  const double size = std::abs(a), sign = a < 0 && term % 2 == 1 ? -1 : 1;
  if (size <= term || size < 1e-3) return sign * std::sph_bessel(unsigned(term), size);
  double last = std::cos(size) / size, now = std::sin(size) / size;  // j₋₁ and j₀
  for (int k = 0; k < term; ++k) last = std::exchange(now, (2 * k + 1) / size * now - last);
  return sign * now;
}

using Complex = std::complex<float>;

PixelLine::PixelLine(int pixels, int samples_per_pixel, int terms, double lit, double scale)
    : pixels_(pixels),
      samples_(pixels * samples_per_pixel),
      pixels_forward_(pixels, FftDirection::forward),
      pixels_backward_(pixels, FftDirection::backward),
      samples_forward_(samples_, FftDirection::forward),
      samples_backward_(samples_, FftDirection::backward),
      pixels_of_block_(pixels),
      samples_of_block_(samples_),
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
  for (const Complex& weight : weights_) conjugates_.push_back(std::conj(weight));
}

void PixelLine::spread(int count, const Complex* terms, Complex* out) const {
  const size_t length = size_t(pixels_), samples = size_t(samples_);
  Workspace::Loan space(workspace_, 2 * (samples + length));
  Complex *of_samples = reinterpret_cast<Complex*>(space.data()), *of_pixels = of_samples + samples;
  for (size_t c = 0; c < size_t(count); ++c) {
    pixels_forward_(terms + c * length, of_pixels);
    for (size_t k = 0; k < samples; k += length)
      (c == 0 ? multiply<float> : multiply_add<float>)(of_samples + k, of_pixels, &weights_[c * samples + k], length);
  }
  samples_backward_(of_samples, out);
}

void PixelLine::gather(int count, const Complex* out, Complex* terms) const {
  const size_t length = size_t(pixels_), samples = size_t(samples_);
  Workspace::Loan space(workspace_, 2 * (samples + length));
  Complex *of_samples = reinterpret_cast<Complex*>(space.data()), *of_pixels = of_samples + samples;
  samples_forward_(out, of_samples);
  for (size_t c = 0; c < size_t(count); ++c) {
    for (size_t k = 0; k < samples; k += length)
      (k == 0 ? multiply<float> : multiply_add<float>)(of_pixels, of_samples + k, &conjugates_[c * samples + k],
                                                       length);
    pixels_backward_(of_pixels, terms + c * length);
  }
}

void PixelLine::spread_block(int count, const Complex* terms, Complex* out) const {
  const size_t length = size_t(pixels_), samples = size_t(samples_);
  Workspace::Loan space(workspace_, 2 * block * (2 * samples + length));
  Complex *of_samples = reinterpret_cast<Complex*>(space.data()), *of_pixels = of_samples + block * samples,
          *work = of_pixels + block * length;
  for (size_t c = 0; c < size_t(count); ++c) {
    pixels_of_block_(FftDirection::forward, terms + c * block * length, of_pixels, work);
    for (size_t k = 0; k < samples; k += length)
      (c == 0 ? multiply_rows<float> : multiply_add_rows<float>)(of_samples + k * block, of_pixels,
                                                                 &weights_[c * samples + k], length, block);
  }
  samples_of_block_(FftDirection::backward, of_samples, out, work);
}

void PixelLine::gather_block(int count, const Complex* out, Complex* terms) const {
  const size_t length = size_t(pixels_), samples = size_t(samples_);
  Workspace::Loan space(workspace_, 2 * block * (2 * samples + length));
  Complex *of_samples = reinterpret_cast<Complex*>(space.data()), *of_pixels = of_samples + block * samples,
          *work = of_pixels + block * length;
  samples_of_block_(FftDirection::forward, out, of_samples, work);
  for (size_t c = 0; c < size_t(count); ++c) {
    for (size_t k = 0; k < samples; k += length)
      (k == 0 ? multiply_rows<float> : multiply_add_rows<float>)(of_pixels, of_samples + k * block,
                                                                 &conjugates_[c * samples + k], length, block);
    pixels_of_block_(FftDirection::backward, of_pixels, terms + c * block * length, work);
  }
}

}  // namespace holotrace
