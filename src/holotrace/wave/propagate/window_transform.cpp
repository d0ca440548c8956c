#include "holotrace/wave/propagate/window_transform.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <vector>

#include "holotrace/base/column_fft.h"
#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"
#include "holotrace/wave/propagate/convolve.h"
#include "holotrace/wave/propagate/propagate.h"

namespace holotrace {
namespace {

// Calls work(n, at, run) for the runs of consecutive frequencies first + n … that lie at `at` … in a transform.
template <class Work>
void each_run(int first, int count, int length, const Work& work) {
  for (int n = 0; n < count;) {
    const int at = wrapped(first + int64_t(n), length), run = std::min(count - n, length - at);
    work(n, at, run);
    n += run;
  }
}

// The work space of a thread for a block of columns. Beyond the rows of the input, `rows` stays 0.
template <class Real>
struct ColumnWork {
  AlignedVector<std::complex<Real>> rows, spectrum, columns, results, bins, sum;
};

// Calls write(o, sum) for each row o of the output, from any thread; sum(to) computes the row.
template <class Real, class Write>
void transform_rows(const BasicField<Real>& field, const Propagator<Real>& p, const Observer& observer,
                    const Write& write) {
  using Complex = std::complex<Real>;
  const PropagationAxis &x = p.x, &y = p.y;
  const WindowSum<Real> sum_x(x), sum_y(y);
  const Fft<Real> forward_x(x.padded, FftDirection::forward);
  const ColumnFft<Real> forward_y(y.padded);

  // 1. Along x: the frequencies in use, each once even if the kernel extends beyond the input's band.
  const int entering = std::min(x.frequencies(), x.padded), count = x.frequencies();
  ColumnBlocks<Real> before(entering, y.inputs);
  parallel_for(0, y.inputs, [&](int64_t j) {
    AlignedVector<Complex> line(size_t(x.padded)), used(size_t(before.blocks_of(entering)) * column_block);
    std::copy_n(field.samples.row(int(j)), x.inputs, line.begin());
    forward_x(line.data());
    each_run(x.first, entering, x.padded,
             [&](int n, int at, int run) { std::copy_n(line.data() + at, run, used.data() + n); });
    for (int b = 0; b < before.blocks_of(entering); ++b)
      copy_block(used.data() + b * column_block, before.at(b, int(j)));
  });
  observer.progress(0.25);

  // 2. Along y: a block of columns at a time.
  tbb::enumerable_thread_specific<ColumnWork<Real>> works([&] {
    const size_t size = size_t(y.padded) * column_block;
    return ColumnWork<Real>{AlignedVector<Complex>(size),
                            AlignedVector<Complex>(size),
                            AlignedVector<Complex>(size),
                            AlignedVector<Complex>(size_t(y.outputs) * column_block),
                            AlignedVector<Complex>(size_t(y.frequencies())),
                            AlignedVector<Complex>(sum_y.work_size())};
  });
  LargeBuffer<Complex> after(size_t(count) * size_t(y.outputs));
  parallel_for(0, before.blocks_of(count), [&](int64_t b) {
    const int first = int(b) * column_block, used = std::min(column_block, count - first);
    auto& [rows, spectrum, columns, results, frequencies, work] = works.local();
    Complex* const bins = frequencies.data();
    if (first + used <= entering)
      std::copy_n(before.at(int(b), 0), y.inputs * column_block, rows.data());
    else
      for (int c = 0; c < used; ++c) {
        const int from = (first + c) % entering;
        const Complex* column = before.at(from / column_block, 0) + from % column_block;
        for (int j = 0; j < y.inputs; ++j)
          rows[size_t(j) * column_block + size_t(c)] = column[size_t(j) * column_block];
      }
    forward_y(FftDirection::forward, rows.data(), spectrum.data(), columns.data());
    turn_to_columns(spectrum.data(), y.padded, columns.data());
    for (int c = 0; c < used; ++c) {
      const Complex *column = columns.data() + size_t(c) * size_t(y.padded), *h = p.transfer.row(first + c);
      each_run(y.first, y.frequencies(), y.padded,
               [&](int n, int at, int run) { multiply(bins + n, column + at, h + n, size_t(run)); });
      sum_y(bins, results.data() + size_t(c) * size_t(y.outputs), work.data());
    }
    for (int o = 0; o < y.outputs; ++o)
      for (int c = 0; c < used; ++c)
        after.data()[size_t(o) * size_t(count) + size_t(first + c)] =
            results[size_t(c) * size_t(y.outputs) + size_t(o)];
  });
  observer.progress(0.75);

  // 3. Along x: to the window.
  parallel_for(0, y.outputs, [&](int64_t row) {
    const int o = int(row);
    write(o, [&](Complex* to) {
      AlignedVector<Complex> work(sum_x.work_size());
      sum_x(after.data() + size_t(o) * size_t(count), to, work.data());
    });
  });
  observer.progress(1);
}

}  // namespace

double window_transform_bytes(const PropagationAxis& x, const PropagationAxis& y, size_t bytes_per_real) {
  const double entering = std::min(x.frequencies(), x.padded) + column_block, leaving = x.frequencies() + column_block;
  return 2.0 * double(bytes_per_real) * (entering * y.inputs + leaving * y.outputs + double(x.outputs) * y.outputs);
}

template <class Real>
BasicField<Real> transform_to_window(const BasicField<Real>& field, const Propagator<Real>& p,
                                     const Observer& observer) {
  auto out = BasicField<Real>::unset(p.output, field.wavelength, field.z + p.distance);
  transform_rows(field, p, observer, [&](int o, const auto& sum) { sum(out.samples.row(o)); });
  return out;
}

Array2D<float> transform_to_irradiance(const Field& field, const Propagator<float>& p, const Observer& observer) {
  auto irradiance = Array2D<float>::unset(p.output.ny, p.output.nx);
  transform_rows(field, p, observer, [&](int o, const auto& sum) {
    AlignedVector<std::complex<float>> row(size_t(p.output.nx));
    sum(row.data());
    irradiance_of_row(row.data(), row.size(), irradiance.row(o));
  });
  return irradiance;
}

template Field transform_to_window(const Field&, const Propagator<float>&, const Observer&);
template FieldDouble transform_to_window(const FieldDouble&, const Propagator<double>&, const Observer&);

}  // namespace holotrace
