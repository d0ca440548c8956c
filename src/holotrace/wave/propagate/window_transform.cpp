#include "holotrace/wave/propagate/window_transform.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/large_buffer.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/wrapped.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"

namespace holotrace {
namespace {

constexpr int block = 16;  // columns processed together, in the cache

// exp(2πi·a·b), reduced in long double: a·b may be 1e9 cycles.
std::complex<double> cis_product(long double a, long double b) {
  const long double cycles = a * b;
  return cis_cycles(double(cycles - std::floor(cycles)));
}

// out(o) = scale·Σ_k bins(k)·exp(i2πk·(offset + o·pitch)/period), k = first … last, along one axis.
template <class Real>
class WindowSum {
  using Complex = std::complex<Real>;

 public:
  explicit WindowSum(const PropagationAxis& axis) : axis_(axis) {
    const double steps = axis.period() / axis.output_pitch;
    is_plain_ =
        std::abs(steps - std::round(steps)) * axis.outputs < 1e-10 && steps < 1e8 && axis.outputs <= steps + 0.5;
    length_ = is_plain_ ? int(std::round(steps)) : fft_good_length(axis.frequencies() + axis.outputs - 1);
    is_plain_ ? prepare_plain() : prepare_chirp();
    forward_ = std::make_unique<Fft<Real>>(length_, FftDirection::forward);
    backward_ = std::make_unique<Fft<Real>>(length_, FftDirection::backward);
  }

  size_t work_size() const { return size_t(length_); }

  void operator()(const Complex* bins, Complex* out, Complex* work) const {
    const size_t count = size_t(axis_.frequencies());
    std::fill(work, work + length_, Complex());
    if (is_plain_) {
      for (size_t n = 0; n < count;) {
        const size_t at = size_t(wrapped(axis_.first + int64_t(n), length_));
        const size_t run = std::min(count - n, size_t(length_) - at);
        multiply_add(work + at, bins + n, enter_.data() + n, run);
        n += run;
      }
      (*backward_)(work);
      multiply(out, work, leave_.data(), size_t(axis_.outputs));
      return;
    }
    multiply(work, bins, enter_.data(), count);
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
  bool is_plain_ = false;
  int length_ = 0;
  std::vector<Complex> enter_, leave_, chirp_;
  std::unique_ptr<Fft<Real>> forward_, backward_;
};

}  // namespace

double window_transform_bytes(const PropagationAxis& x, const PropagationAxis& y, size_t bytes_per_real) {
  const double entering = std::min(x.frequencies(), x.padded), leaving = x.frequencies() + block;
  return 2.0 * double(bytes_per_real) * (entering * y.inputs + leaving * y.outputs + double(x.outputs) * y.outputs);
}

template <class Real>
BasicField<Real> transform_to_window(const BasicField<Real>& field, const Propagator<Real>& p,
                                     const Observer& observer) {
  using Complex = std::complex<Real>;
  const PropagationAxis &x = p.x, &y = p.y;
  BasicField<Real> out(p.output, field.wavelength, field.z + p.distance);
  const WindowSum<Real> sum_x(x), sum_y(y);
  const Fft<Real> forward_x(x.padded, FftDirection::forward), forward_y(y.padded, FftDirection::forward);

  // 1. Along x: the frequencies in use, each once even if the kernel extends beyond the input's band.
  const int entering = std::min(x.frequencies(), x.padded);
  LargeBuffer<Complex> before(size_t(entering) * size_t(y.inputs));
  parallel_for(0, y.inputs, [&](int64_t j) {
    AlignedVector<Complex> line(size_t(x.padded));
    std::copy_n(field.samples.row(int(j)), x.inputs, line.begin());
    forward_x(line.data());
    Complex* to = before.data() + size_t(j) * size_t(entering);
    for (int n = 0; n < entering; ++n) to[n] = line[size_t(wrapped(x.first + n, x.padded))];
  });
  observer.progress(0.25);

  // 2. Along y: a few columns at a time.
  const int count = x.frequencies(), blocks = (count + block - 1) / block;
  LargeBuffer<Complex> after(size_t(count) * size_t(y.outputs));
  parallel_for(0, blocks, [&](int64_t b) {
    const int first = int(b) * block, columns = std::min(block, count - first);
    AlignedVector<Complex> lines(size_t(y.padded) * block), results(size_t(y.outputs) * block),
        bins(size_t(y.frequencies())), work(sum_y.work_size());
    for (int j = 0; j < y.inputs; ++j)
      for (int c = 0; c < columns; ++c)
        lines[size_t(c) * size_t(y.padded) + size_t(j)] =
            before.data()[size_t(j) * size_t(entering) + size_t((first + c) % entering)];
    for (int c = 0; c < columns; ++c) {
      Complex* line = lines.data() + size_t(c) * size_t(y.padded);
      forward_y(line);
      const Complex* h = p.transfer.row(first + c);
      for (int n = 0; n < y.frequencies();) {
        const int at = wrapped(y.first + int64_t(n), y.padded), run = std::min(y.frequencies() - n, y.padded - at);
        multiply(bins.data() + n, line + at, h + n, size_t(run));
        n += run;
      }
      sum_y(bins.data(), results.data() + size_t(c) * size_t(y.outputs), work.data());
    }
    for (int o = 0; o < y.outputs; ++o)
      for (int c = 0; c < columns; ++c)
        after.data()[size_t(o) * size_t(count) + size_t(first + c)] =
            results[size_t(c) * size_t(y.outputs) + size_t(o)];
  });
  observer.progress(0.75);

  // 3. Along x: to the window.
  parallel_for(0, y.outputs, [&](int64_t o) {
    AlignedVector<Complex> work(sum_x.work_size());
    sum_x(after.data() + size_t(o) * size_t(count), out.samples.row(int(o)), work.data());
  });
  observer.progress(1);
  return out;
}

template Field transform_to_window(const Field&, const Propagator<float>&, const Observer&);
template FieldDouble transform_to_window(const FieldDouble&, const Propagator<double>&, const Observer&);

}  // namespace holotrace
