#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/cycles.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/large_buffer.h"
#include "holotrace/wave/propagate/propagation_axis.h"
#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// exp(2πi·a·b), reduced in long double: a·b may be 1e9 cycles.
inline std::complex<double> cis_product(long double a, long double b) {
  const long double cycles = a * b;
  return cis_cycles(double(cycles - std::floor(cycles)));
}

/// The transforms of a WindowSum: one transform back if it is plain; otherwise two, of a convolution with a chirp.
struct WindowLength {
  bool is_plain;
  int length;
};

inline WindowLength window_length(const PropagationAxis& axis) {
  const double steps = axis.period() / axis.output_pitch;
  if (std::abs(steps - std::round(steps)) * axis.outputs < 1e-10 && steps < 1e8 && axis.outputs <= steps + 0.5)
    return {true, int(std::round(steps))};
  return {false, fft_good_length(axis.frequencies() + axis.outputs - 1)};
}

/// out(o) = scale·Σ_k bins(k)·exp(i2πk·(offset + o·pitch)/period), k = first … last, along one axis.
template <class Real>
class WindowSum {
  using Complex = std::complex<Real>;

 public:
  explicit WindowSum(const PropagationAxis& axis)
      : axis_(axis), is_plain_(window_length(axis).is_plain), length_(window_length(axis).length) {
    is_plain_ ? prepare_plain() : prepare_chirp();
    forward_ = std::make_unique<Fft<Real>>(length_, FftDirection::forward);
    backward_ = std::make_unique<Fft<Real>>(length_, FftDirection::backward);
  }

  bool is_plain() const { return is_plain_; }
  int length() const { return length_; }
  const std::vector<Complex>& enter() const { return enter_; }  ///< factors of the bins
  const std::vector<Complex>& chirp() const { return chirp_; }  ///< factors between the transforms
  const std::vector<Complex>& leave() const { return leave_; }  ///< factors of the outputs

  size_t work_size() const { return size_t(length_); }

  void operator()(const Complex* bins, Complex* out, Complex* work) const {
    const size_t count = size_t(axis_.frequencies());
    if (is_plain_) {
      enter_plain(bins, work);
      (*backward_)(work);
      multiply(out, work, leave_.data(), size_t(axis_.outputs));
      return;
    }
    multiply(work, bins, enter_.data(), count);
    std::fill(work + count, work + length_, Complex());
    (*forward_)(work);
    multiply(work, work, chirp_.data(), size_t(length_));
    (*backward_)(work);
    multiply(out, work, leave_.data(), size_t(axis_.outputs));
  }

 private:
  void prepare_plain() {
    for (int k = axis_.first; k <= axis_.last; ++k)
      enter_.push_back(Complex(cis_product(k, (long double)axis_.offset / axis_.period())));
    leave_.assign(size_t(axis_.outputs), Complex(Real(1.0 / axis_.padded)));
  }

  // Frequencies that are a whole turn of the output apart are added.
  void enter_plain(const Complex* bins, Complex* work) const {
    const size_t count = size_t(axis_.frequencies()), length = size_t(length_);
    const size_t start = size_t(wrapped(axis_.first, length_)), used = std::min(count, length);
    if (start + used <= length) {
      std::fill(work, work + start, Complex());
      std::fill(work + start + used, work + length, Complex());
    } else {
      std::fill(work + (start + used - length), work + start, Complex());
    }
    for (size_t n = 0; n < count;) {
      const bool is_first_turn = n < length;
      const size_t at = (start + n) % length;
      const size_t run = std::min((is_first_turn ? used : count) - n, length - at);
      if (is_first_turn)
        multiply(work + at, bins + n, enter_.data() + n, run);
      else
        multiply_add(work + at, bins + n, enter_.data() + n, run);
      n += run;
    }
  }

  // Bluestein: k·o = (k² + o² − (o − k)²)/2, with k counted from first.
  void prepare_chirp() {
    const long double step = (long double)axis_.output_pitch / axis_.period();
    const long double start = (long double)axis_.offset / axis_.period();
    const int count = axis_.frequencies();
    const auto half_square = [](int64_t n) { return (long double)n * (long double)n / 2; };
    for (int k = 0; k < count; ++k)
      enter_.push_back(Complex(cis_product(k, start) * cis_product(half_square(k), step)));
    for (int o = 0; o < axis_.outputs; ++o)
      leave_.push_back(Complex(cis_product(axis_.first, start + o * step) * cis_product(half_square(o), step) /
                               (double(length_) * axis_.padded)));
    AlignedVector<std::complex<double>> chirp(static_cast<size_t>(length_));
    for (int n = 1 - count; n < axis_.outputs; ++n)
      chirp[size_t(wrapped(n, length_))] = std::conj(cis_product(half_square(n), step));
    Fft<double>(length_, FftDirection::forward)(chirp.data());
    for (const auto& c : chirp) chirp_.push_back(Complex(c));
  }

  PropagationAxis axis_;
  bool is_plain_;
  int length_;
  std::vector<Complex> enter_, leave_, chirp_;
  std::unique_ptr<Fft<Real>> forward_, backward_;
};

/// A field through a propagator to a window of any pitch, size and centre.
///
///     out(o) = 1/XY·Σ_{k,l} H(k, l)·û(k, l)·exp(i2π(k·x(o)/T_x + l·y(o′)/T_y)),   û the transform of the padded input
///
/// The sum over the frequencies in use is a matrix Fourier transform. It is done by plain transforms if the period T is
/// a whole number of output samples, otherwise by chirps (Bluestein 1970; Rabiner, Schafer & Rader 1969).
template <class Real>
BasicField<Real> transform_to_window(const BasicField<Real>& field, const Propagator<Real>& propagator,
                                     const Observer& observer);

/// The irradiance |out|² [W/m²] of transform_to_window, without holding the field.
Array2D<float> transform_to_irradiance(const Field& field, const Propagator<float>& propagator,
                                       const Observer& observer);

/// Bytes that transform_to_window needs beside the field and the propagator, including its result.
double window_transform_bytes(const PropagationAxis& x, const PropagationAxis& y, size_t bytes_per_real);

}  // namespace holotrace
