#include "holotrace/wave/propagate/window_transform.h"

#include <algorithm>
#include <vector>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/large_buffer.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/wrapped.h"
#include "holotrace/wave/propagate/window_sum.h"

namespace holotrace {
namespace {

constexpr int block = 16;  // columns processed together, in the cache

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
