#include "holotrace/wave/propagate/convolve.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <vector>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/large_buffer.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/wrapped.h"
#include "holotrace/wave/propagate/column_blocks.h"
#include "holotrace/wave/shared/spherical_wave_kernel.h"

namespace holotrace {
namespace {

// One part of one axis: the frequencies k ≡ part modulo axis.parts.
template <class Real>
struct Part {
  using Complex = std::complex<Real>;
  const PropagationAxis& axis;
  int part, length, columns;  // columns: number of frequencies in use
  int first;                  // the least of them
  std::vector<Complex> enter, leave;

  Part(const PropagationAxis& a, int part, double scale)
      : axis(a),
        part(part),
        length(a.part_length()),
        columns(0),
        first(a.first + wrapped(part - a.first, a.parts)),
        enter(size_t(a.inputs)),
        leave(size_t(a.outputs)) {
    if (first <= a.last) columns = (a.last - first) / a.parts + 1;
    for (int i = 0; i < a.inputs; ++i) enter[size_t(i)] = Complex(turn(-i));
    for (int o = 0; o < a.outputs; ++o) leave[size_t(o)] = Complex(scale * turn(wrapped(o + a.shift, a.padded)));
  }

  std::complex<double> turn(int64_t place) const {
    return cis_cycles(double(place * part % axis.padded) / axis.padded);
  }
  int frequency(int column) const { return first + column * axis.parts; }
  // Columns are in the order of their frequencies; negative ones, which end the transform, come first.
  int below_zero() const { return std::min(columns, first < 0 ? (-first + axis.parts - 1) / axis.parts : 0); }
  int bin(int column) const { return wrapped(frequency(column), axis.padded) / axis.parts; }

  // Calls work(o, at, count) for each run of outputs o … that are consecutive, from `at` on, in the part's period.
  template <class Work>
  void each_run_of_outputs(const Work& work) const {
    for (int o = 0; o < axis.outputs;) {
      const int at = wrapped(o + axis.shift, length), count = std::min(axis.outputs - o, length - at);
      work(o, at, count);
      o += count;
    }
  }
};

// Blocks of columns for a part of the spectrum along x: [block][row][column in block].
template <class Real>
struct Blocks {
  int rows;
  LargeBuffer<std::complex<Real>> values;

  Blocks(int columns, int rows) : rows(rows), values(size_t(blocks_of(columns)) * size_t(rows) * block) {}
  static int blocks_of(int columns) { return (columns + block - 1) / block; }
  std::complex<Real>* at(int b, int row) { return values.data() + (size_t(b) * size_t(rows) + size_t(row)) * block; }
};

template <class Real>
class Convolution {
  using Complex = std::complex<Real>;

 public:
  Convolution(const BasicField<Real>& field, const Propagator<Real>& p, BasicField<Real>& out)
      : field_(field),
        p_(p),
        out_(out),
        is_band_limited_(p.x.frequencies() < p.x.padded || p.y.frequencies() < p.y.padded),
        forward_x_(p.x.part_length(), {}, FftDirection::forward),
        backward_x_(p.x.part_length(), {}, FftDirection::backward),
        to_columns_(p.y.part_length(), {block, block, 1, 1, p.y.part_length()}, FftDirection::forward),
        backward_y_(p.y.part_length(), FftDirection::backward) {
    for (int part = 0; part < p.y.parts; ++part) parts_y_.emplace_back(p.y, part, 1);
  }

  void run(int part, Blocks<Real>& blocks) {
    const Part<Real> x(p_.x, part, 1.0 / (double(p_.x.padded) * p_.y.padded));
    const int count = Blocks<Real>::blocks_of(x.columns);
    std::vector<double> of_rows(size_t(p_.y.inputs)), of_blocks(static_cast<size_t>(count));
    parallel_for(
        0, p_.y.inputs, [&](int64_t j) { of_rows[size_t(j)] = forward_row(x, int(j), blocks); }, {}, 8);
    parallel_for(0, count, [&](int64_t b) { of_blocks[size_t(b)] = filter_columns(x, int(b), blocks); });
    parallel_for(
        0, p_.y.outputs, [&](int64_t o) { backward_row(x, int(o), blocks); }, {}, 8);
    for (const double e : of_rows) dropped_ += e * p_.y.padded;  // by Parseval's theorem along y
    for (const double e : of_blocks) dropped_ += e;
  }

  bool is_band_limited() const { return is_band_limited_; }

  double dropped_part() const {
    double all = 0;
    for (int j = 0; j < field_.grid.ny; ++j) all += energy(field_.samples.row(j), size_t(field_.grid.nx));
    all *= double(p_.x.padded) * p_.y.padded;
    return all > 0 ? dropped_ / all : 0;
  }

 private:
  // Copies the columns [column, end) of a row from a line into their blocks, or back.
  enum class Into { blocks, line };
  template <Into into>
  static void move_row(Blocks<Real>& blocks, int row, int column, int end, Complex* line) {
    for (; column < end; ++column, ++line) {
      Complex* held = blocks.at(column / block, row) + column % block;
      Complex* to = into == Into::blocks ? held : line;
      const Complex* from = into == Into::blocks ? line : held;
      if (column % block == 0 && column + block <= end) {
        copy_block(from, to);
        column += block - 1;
        line += block - 1;
      } else {
        *to = *from;
      }
    }
  }

  // Transforms along x and stores the frequencies in use in their blocks.
  double forward_row(const Part<Real>& x, int j, Blocks<Real>& blocks) const {
    const int length = x.length, inputs = p_.x.inputs;
    AlignedVector<Complex> work(2 * size_t(length));
    Complex *line = work.data(), *bins = work.data() + length;
    const Complex* row = field_.samples.row(j);
    for (int i = 0; i < inputs; i += length) {
      const size_t count = size_t(std::min(length, inputs - i));
      if (i == 0 && x.part == 0)
        std::copy_n(row, count, line);
      else if (i == 0)
        multiply(line, row, x.enter.data(), count);
      else
        multiply_add(line, row + i, x.enter.data() + i, count);
    }
    forward_x_(line, bins);
    const int below = x.below_zero();
    if (below > 0) move_row<Into::blocks>(blocks, j, 0, below, bins + x.bin(0));
    if (below < x.columns) move_row<Into::blocks>(blocks, j, below, x.columns, bins + x.bin(below));
    if (x.columns % block != 0) {  // the rest of the last block is transformed too, and must be finite
      Complex* last = blocks.at(x.columns / block, j);
      std::fill(last + x.columns % block, last + block, Complex());
    }
    return x.columns < length ? energy(bins, size_t(length)) - held_energy(x, bins) : 0;
  }

  double held_energy(const Part<Real>& x, const Complex* bins) const {
    const int below = x.below_zero();
    return (below > 0 ? energy(bins + x.bin(0), size_t(below)) : 0) +
           (below < x.columns ? energy(bins + x.bin(below), size_t(x.columns - below)) : 0);
  }

  // Transforms along y, filters, and transforms back, in the cache. The first part is done last: it can use the block
  // itself.
  double filter_columns(const Part<Real>& x, int b, Blocks<Real>& blocks) {
    const int length = p_.y.part_length(), parts = p_.y.parts;
    const size_t size = size_t(length) * block;
    AlignedVector<Complex>& work = work_.local();
    work.resize(size * size_t(parts + 1));
    Complex* columns = work.data() + size * size_t(parts);  // stored one after the other
    double dropped = 0;
    for (int part = parts - 1; part >= 0; --part) {
      Complex* rows = work.data() + size * size_t(part);
      const bool enters_whole = part == 0 && p_.y.inputs == length;
      const bool leaves_whole = part == 0 && p_.y.outputs == length && p_.y.shift == 0;
      if (!enters_whole) enter_part(parts_y_[size_t(part)], b, blocks, rows);
      to_columns_(enters_whole ? blocks.at(b, 0) : rows, columns);
      for (int c = 0; c < std::min(block, x.columns - b * block); ++c) {
        Complex* column = columns + size_t(c) * size_t(length);
        dropped += dropped_energy(part, column);
        const Complex* h = p_.transfer.row(p_.x.slot(x.frequency(b * block + c))) + part * length;
        multiply(column, column, h, size_t(length));
        backward_y_(column);
      }
      turn_to_rows(columns, length, leaves_whole ? blocks.at(b, 0) : rows);
      if (part == 0 && !leaves_whole) leave_part(parts_y_[0], b, blocks, rows);
    }
    for (int part = 1; part < parts; ++part)
      leave_part(parts_y_[size_t(part)], b, blocks, work.data() + size * size_t(part));
    return dropped;
  }

  void enter_part(const Part<Real>& y, int b, Blocks<Real>& blocks, Complex* rows) const {
    for (int j = 0; j < p_.y.inputs; j += y.length) {
      const int count = std::min(y.length, p_.y.inputs - j);
      if (j == 0 && y.part == 0)
        std::copy_n(blocks.at(b, 0), count * block, rows);
      else if (j == 0)
        multiply_rows(rows, blocks.at(b, 0), y.enter.data(), size_t(count), block);
      else
        multiply_add_rows(rows, blocks.at(b, j), y.enter.data() + j, size_t(count), block);
    }
    if (p_.y.inputs < y.length) std::fill(rows + p_.y.inputs * block, rows + y.length * block, Complex());
  }

  void leave_part(const Part<Real>& y, int b, Blocks<Real>& blocks, const Complex* rows) const {
    y.each_run_of_outputs([&](int o, int at, int count) {
      if (y.part == 0)
        std::copy_n(rows + at * block, count * block, blocks.at(b, o));
      else
        multiply_add_rows(blocks.at(b, o), rows + at * block, y.leave.data() + o, size_t(count), block);
    });
  }

  // Energy of the frequencies last + 1 … padded + first − 1 of y in this part.
  double dropped_energy(int part, const Complex* column) const {
    const PropagationAxis& y = p_.y;
    const int from = y.last + 1 + wrapped(part - y.last - 1, y.parts);
    const int to = y.padded + y.first;
    if (from >= to) return 0;
    const int count = (to - from + y.parts - 1) / y.parts;
    if (y.last >= 0 && y.first <= 0) return energy(column + from / y.parts, size_t(count));
    double sum = 0;  // if the band lies to one side of zero, the dropped frequencies wrap around
    for (int n = 0; n < count; ++n) sum += std::norm(column[wrapped(from + n * y.parts, y.padded) / y.parts]);
    return sum;
  }

  // Transforms back along x and adds the result to the outputs.
  void backward_row(const Part<Real>& x, int o, Blocks<Real>& blocks) {
    const int length = x.length;
    AlignedVector<Complex> work(2 * size_t(length));
    Complex *bins = work.data(), *line = work.data() + length;
    const int below = x.below_zero();
    if (below > 0) move_row<Into::line>(blocks, o, 0, below, bins + x.bin(0));
    if (below < x.columns) move_row<Into::line>(blocks, o, below, x.columns, bins + x.bin(below));
    backward_x_(bins, line);
    Complex* row = out_.samples.row(o);
    x.each_run_of_outputs([&](int first, int at, int count) {
      if (x.part == 0)
        multiply(row + first, line + at, x.leave.data() + first, size_t(count));
      else
        multiply_add(row + first, line + at, x.leave.data() + first, size_t(count));
    });
  }

  const BasicField<Real>& field_;
  const Propagator<Real>& p_;
  BasicField<Real>& out_;
  const bool is_band_limited_;
  double dropped_ = 0;
  const FftBatch<Real> forward_x_, backward_x_, to_columns_;
  const Fft<Real> backward_y_;
  std::vector<Part<Real>> parts_y_;
  tbb::enumerable_thread_specific<AlignedVector<Complex>> work_;  // work space per thread, for its current block
};

}  // namespace

double convolution_bytes(const PropagationAxis& x, const PropagationAxis& y, size_t bytes_per_real) {
  const double columns = double(x.frequencies()) / x.parts + block;
  return 2.0 * double(bytes_per_real) * (columns * std::max(y.inputs, y.outputs) + double(x.outputs) * y.outputs);
}

template <class Real>
BasicField<Real> convolve(const BasicField<Real>& field, const Propagator<Real>& p, const Observer& observer) {
  BasicField<Real> out(p.output, field.wavelength, field.z + p.distance);
  Convolution<Real> convolution(field, p, out);
  const int most = (p.x.frequencies() + p.x.parts - 1) / p.x.parts;
  Blocks<Real> blocks(most, std::max(p.y.inputs, p.y.outputs));
  for (int part = 0; part < p.x.parts; ++part) {
    convolution.run(part, blocks);
    observer.progress((part + 1.0) / p.x.parts);
  }
  if (convolution.is_band_limited()) observer.fact("energy_beyond_band", convolution.dropped_part());
  return out;
}

template Field convolve(const Field&, const Propagator<float>&, const Observer&);
template FieldDouble convolve(const FieldDouble&, const Propagator<double>&, const Observer&);

}  // namespace holotrace
