#include "holotrace/wave/propagate/convolve.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/error.h"
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

// exp(2πi·k·shift/padded) for the frequencies k of an axis, which displaces samples by `shift`; empty for 0.
// `frequency(i)` is that of slot i, between −padded/2 and padded/2.
template <class Real, class Frequency>
std::vector<std::complex<Real>> ramp(const PropagationAxis& axis, double shift, int slots, const Frequency& frequency) {
  std::vector<std::complex<Real>> values(shift == 0 ? 0 : size_t(slots));
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = std::complex<Real>(cis_cycles(double(frequency(int(i))) * shift / axis.padded));
  return values;
}

int signed_frequency(int k, int padded) { return 2 * k < padded ? k : k - padded; }

// One field to one or several, or several fields to one, which is their sum. Input i is in blocks[i], and output o is
// left in blocks[o].
template <class Real>
class Convolution {
  using Complex = std::complex<Real>;

 public:
  Convolution(const std::vector<const BasicField<Real>*>& fields, const std::vector<ConvolutionLink<Real>>& links,
              std::vector<BasicField<Real>>& outputs)
      : fields_(fields),
        links_(links),
        out_(outputs),
        p_(*links.front().propagator),
        is_band_limited_(p_.x.frequencies() < p_.x.padded || p_.y.frequencies() < p_.y.padded),
        forward_x_(p_.x.part_length(), {}, FftDirection::forward),
        backward_x_(p_.x.part_length(), {}, FftDirection::backward),
        to_columns_(p_.y.part_length(), {block, block, 1, 1, p_.y.part_length()}, FftDirection::forward),
        backward_y_(p_.y.part_length(), FftDirection::backward) {
    for (int part = 0; part < p_.y.parts; ++part) parts_y_.emplace_back(p_.y, part, 1);
    for (const ConvolutionLink<Real>& link : links)
      ramps_y_.push_back(ramp<Real>(p_.y, link.shift_y, p_.y.padded, [&](int slot) {
        const int length = p_.y.part_length();
        return signed_frequency(slot / length + slot % length * p_.y.parts, p_.y.padded);
      }));
  }

  void run(int part, std::vector<Blocks<Real>>& blocks) {
    const Part<Real> x(p_.x, part, 1.0 / (double(p_.x.padded) * p_.y.padded));
    const int count = Blocks<Real>::blocks_of(x.columns);
    ramps_x_.clear();
    for (const ConvolutionLink<Real>& link : links_)
      ramps_x_.push_back(ramp<Real>(p_.x, link.shift_x, x.columns, [&](int column) { return x.frequency(column); }));
    std::vector<double> of_rows(size_t(p_.y.inputs)), of_blocks(static_cast<size_t>(count));
    for (size_t i = 0; i < fields_.size(); ++i)
      parallel_for(
          0, p_.y.inputs, [&](int64_t j) { of_rows[size_t(j)] = forward_row(x, i, int(j), blocks[i]); }, {}, 8);
    parallel_for(0, count, [&](int64_t b) { of_blocks[size_t(b)] = filter_columns(x, int(b), blocks); });
    for (size_t o = 0; o < out_.size(); ++o)
      parallel_for(
          0, p_.y.outputs, [&](int64_t row) { backward_row(x, o, int(row), blocks[o]); }, {}, 8);
    for (const double e : of_rows) dropped_ += e * p_.y.padded;  // by Parseval's theorem along y
    for (const double e : of_blocks) dropped_ += e;
  }

  bool is_band_limited() const { return is_band_limited_; }

  double dropped_part() const {
    const BasicField<Real>& field = *fields_.front();
    double all = 0;
    for (int j = 0; j < field.grid.ny; ++j) all += energy(field.samples.row(j), size_t(field.grid.nx));
    all *= double(p_.x.padded) * p_.y.padded;
    return all > 0 ? dropped_ / all : 0;
  }

 private:
  bool has_many_inputs() const { return fields_.size() > 1; }

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

  // The frequencies in use of a row are at bins + bin(0) … for those below zero, and at bins + bin(below) … for the
  // rest. Multiplies them by a ramp.
  static void multiply_bins(const Part<Real>& x, const std::vector<Complex>& ramp, Complex* bins) {
    if (ramp.empty()) return;
    const int below = x.below_zero();
    if (below > 0) multiply(bins + x.bin(0), bins + x.bin(0), ramp.data(), size_t(below));
    if (below < x.columns)
      multiply(bins + x.bin(below), bins + x.bin(below), ramp.data() + below, size_t(x.columns - below));
  }

  // Transforms along x and stores the frequencies in use in their blocks.
  double forward_row(const Part<Real>& x, size_t input, int j, Blocks<Real>& blocks) const {
    const int length = x.length, inputs = p_.x.inputs;
    AlignedVector<Complex> work(2 * size_t(length));
    Complex *line = work.data(), *bins = work.data() + length;
    const Complex* row = fields_[input]->samples.row(j);
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
    const double dropped = x.columns < length ? energy(bins, size_t(length)) - held_energy(x, bins) : 0;
    if (has_many_inputs()) multiply_bins(x, ramps_x_[input], bins);
    const int below = x.below_zero();
    if (below > 0) move_row<Into::blocks>(blocks, j, 0, below, bins + x.bin(0));
    if (below < x.columns) move_row<Into::blocks>(blocks, j, below, x.columns, bins + x.bin(below));
    if (x.columns % block != 0) {  // the rest of the last block is transformed too, and must be finite
      Complex* last = blocks.at(x.columns / block, j);
      std::fill(last + x.columns % block, last + block, Complex());
    }
    return dropped;
  }

  double held_energy(const Part<Real>& x, const Complex* bins) const {
    const int below = x.below_zero();
    return (below > 0 ? energy(bins + x.bin(0), size_t(below)) : 0) +
           (below < x.columns ? energy(bins + x.bin(below), size_t(x.columns - below)) : 0);
  }

  // Transforms along y, filters, and transforms back, in the cache. The first part is done last: it can use the blocks
  // themselves.
  double filter_columns(const Part<Real>& x, int b, std::vector<Blocks<Real>>& blocks) {
    const int length = p_.y.part_length(), parts = p_.y.parts;
    const size_t size = size_t(length) * block, outputs = out_.size();
    AlignedVector<Complex>& work = work_.local();
    work.resize(size * (size_t(parts) * outputs + 2));
    Complex* columns = work.data() + size * size_t(parts) * outputs;  // stored one after the other
    Complex* filtered = outputs > 1 || fields_.size() > 1 ? columns + size : columns;
    const auto rows = [&](size_t output, int part) {
      return work.data() + size * (output * size_t(parts) + size_t(part));
    };
    double dropped = 0;
    for (int part = parts - 1; part >= 0; --part) {
      const bool enters_whole = part == 0 && p_.y.inputs == length;
      const bool leaves_whole = part == 0 && p_.y.outputs == length && p_.y.shift == 0;
      for (size_t i = 0; i < fields_.size(); ++i) {
        if (!enters_whole) enter_part(parts_y_[size_t(part)], b, blocks[i], rows(0, part));
        to_columns_(enters_whole ? blocks[i].at(b, 0) : rows(0, part), columns);
        for (int c = 0; c < used_columns(x, b); ++c)
          dropped += dropped_energy(part, columns + size_t(c) * size_t(length));
        if (has_many_inputs()) {
          for (int c = 0; c < used_columns(x, b); ++c)
            filter(x.frequency(b * block + c), part, i, i > 0, columns + size_t(c) * size_t(length),
                   filtered + size_t(c) * size_t(length));
          continue;
        }
        for (size_t o = 0; o < outputs; ++o) {
          for (int c = 0; c < used_columns(x, b); ++c)
            filter(x.frequency(b * block + c), part, o, false, columns + size_t(c) * size_t(length),
                   filtered + size_t(c) * size_t(length));
          leave_columns(x, b, leaves_whole ? blocks[o].at(b, 0) : rows(o, part), filtered);
        }
      }
      if (has_many_inputs()) leave_columns(x, b, leaves_whole ? blocks[0].at(b, 0) : rows(0, part), filtered);
      if (part == 0 && !leaves_whole)
        for (size_t o = 0; o < outputs; ++o) leave_part(parts_y_[0], b, blocks[o], rows(o, 0));
    }
    for (size_t o = 0; o < outputs; ++o)
      for (int part = 1; part < parts; ++part) leave_part(parts_y_[size_t(part)], b, blocks[o], rows(o, part));
    return dropped;
  }

  static int used_columns(const Part<Real>& x, int b) { return std::min(block, x.columns - b * block); }

  // to = column · transfer function of a link, or to += that.
  void filter(int frequency, int part, size_t link, bool adds, Complex* column, Complex* to) const {
    const size_t length = size_t(p_.y.part_length()), from = size_t(part) * length;
    const Propagator<Real>& p = *links_[link].propagator;
    const Complex* h = p.transfer.row(p.x.slot(frequency)) + from;
    const Complex* ramp = ramps_y_[link].empty() ? nullptr : ramps_y_[link].data() + from;
    if (adds && ramp) multiply(column, column, ramp, length);  // this input has a column of its own
    if (links_[link].is_adjoint)
      adds ? multiply_conjugate_add(to, column, h, length) : multiply_conjugate(to, column, h, length);
    else
      adds ? multiply_add(to, column, h, length) : multiply(to, column, h, length);
    if (!adds && ramp) multiply(to, to, ramp, length);
  }

  void leave_columns(const Part<Real>& x, int b, Complex* rows, Complex* columns) const {
    const int length = p_.y.part_length();
    for (int c = 0; c < used_columns(x, b); ++c) backward_y_(columns + size_t(c) * size_t(length));
    turn_to_rows(columns, length, rows);
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
  void backward_row(const Part<Real>& x, size_t output, int o, Blocks<Real>& blocks) {
    const int length = x.length;
    AlignedVector<Complex> work(2 * size_t(length));
    Complex *bins = work.data(), *line = work.data() + length;
    const int below = x.below_zero();
    if (below > 0) move_row<Into::line>(blocks, o, 0, below, bins + x.bin(0));
    if (below < x.columns) move_row<Into::line>(blocks, o, below, x.columns, bins + x.bin(below));
    if (!has_many_inputs()) multiply_bins(x, ramps_x_[output], bins);
    backward_x_(bins, line);
    Complex* row = out_[output].samples.row(o);
    x.each_run_of_outputs([&](int first, int at, int count) {
      if (x.part == 0)
        multiply(row + first, line + at, x.leave.data() + first, size_t(count));
      else
        multiply_add(row + first, line + at, x.leave.data() + first, size_t(count));
    });
  }

  const std::vector<const BasicField<Real>*>& fields_;
  const std::vector<ConvolutionLink<Real>>& links_;
  std::vector<BasicField<Real>>& out_;
  const Propagator<Real>& p_;  // its axes are those of all
  const bool is_band_limited_;
  double dropped_ = 0;
  const FftBatch<Real> forward_x_, backward_x_, to_columns_;
  const Fft<Real> backward_y_;
  std::vector<Part<Real>> parts_y_;
  std::vector<std::vector<Complex>> ramps_x_, ramps_y_;           // of each link; ramps_x_ for the part of x at work
  tbb::enumerable_thread_specific<AlignedVector<Complex>> work_;  // work space per thread, for its current block
};

}  // namespace

double convolution_bytes(const PropagationAxis& x, const PropagationAxis& y, size_t bytes_per_real) {
  const double columns = double(x.frequencies()) / x.parts + block;
  return 2.0 * double(bytes_per_real) * (columns * std::max(y.inputs, y.outputs) + double(x.outputs) * y.outputs);
}

namespace {

template <class Real>
void check_links(const std::vector<ConvolutionLink<Real>>& links) {
  const Propagator<Real>& first = *links.front().propagator;
  for (const ConvolutionLink<Real>& link : links) {
    const Propagator<Real>& p = *link.propagator;
    require(p.is_on_lattice(), "expected propagations between windows of one pitch, got two pitches");
    require(p.input == first.input && p.output == first.output && p.padded_nx == first.padded_nx &&
                p.padded_ny == first.padded_ny && p.x.first == first.x.first && p.x.last == first.x.last,
            "expected propagations with the same windows and the same band");
    require(!link.is_adjoint || p.input == p.output, "expected equal windows for an adjoint propagation");
  }
}

// Does the work of all links. Returns the part of the light that the band limit drops, if it is limited.
template <class Real>
std::optional<double> run_links(const std::vector<const BasicField<Real>*>& fields,
                                const std::vector<ConvolutionLink<Real>>& links, std::vector<BasicField<Real>>& outputs,
                                const Observer& observer) {
  const Propagator<Real>& p = *links.front().propagator;
  Convolution<Real> convolution(fields, links, outputs);
  const int most = (p.x.frequencies() + p.x.parts - 1) / p.x.parts;
  std::vector<Blocks<Real>> blocks;
  for (size_t i = 0; i < links.size(); ++i) blocks.emplace_back(most, std::max(p.y.inputs, p.y.outputs));
  for (int part = 0; part < p.x.parts; ++part) {
    convolution.run(part, blocks);
    observer.progress((part + 1.0) / p.x.parts);
  }
  return convolution.is_band_limited() ? std::optional(convolution.dropped_part()) : std::nullopt;
}

template <class Real>
BasicField<Real> output_of(const ConvolutionLink<Real>& link, double wavelength, double z) {
  const Propagator<Real>& p = *link.propagator;
  BasicField<Real> out(p.output, wavelength, z + (link.is_adjoint ? -p.distance : p.distance));
  out.grid.centre_x += link.shift_x * out.grid.pitch;
  out.grid.centre_y -= link.shift_y * out.grid.pitch;
  return out;
}

}  // namespace

template <class Real>
BasicField<Real> convolve(const BasicField<Real>& field, const Propagator<Real>& p, const Observer& observer) {
  std::vector<BasicField<Real>> out;
  out.push_back(output_of(ConvolutionLink<Real>{&p}, field.wavelength, field.z));
  const auto dropped = run_links<Real>({&field}, {{&p}}, out, observer);
  if (dropped) observer.fact("energy_beyond_band", *dropped);
  return std::move(out.front());
}

template <class Real>
std::vector<BasicField<Real>> convolve_to_many(const BasicField<Real>& field,
                                               const std::vector<ConvolutionLink<Real>>& links) {
  check_links(links);
  std::vector<BasicField<Real>> out;
  for (const ConvolutionLink<Real>& link : links) out.push_back(output_of(link, field.wavelength, field.z));
  run_links<Real>({&field}, links, out, {});
  return out;
}

template <class Real>
BasicField<Real> convolve_to_sum(const std::vector<const BasicField<Real>*>& fields,
                                 const std::vector<ConvolutionLink<Real>>& links) {
  check_links(links);
  require(fields.size() == links.size(), "expected a propagation for each of {} fields, got {}", fields.size(),
          links.size());
  std::vector<BasicField<Real>> out;
  out.push_back(BasicField<Real>(links.front().propagator->output, fields.front()->wavelength));
  run_links<Real>(fields, links, out, {});
  return std::move(out.front());
}

template Field convolve(const Field&, const Propagator<float>&, const Observer&);
template FieldDouble convolve(const FieldDouble&, const Propagator<double>&, const Observer&);
template std::vector<Field> convolve_to_many(const Field&, const std::vector<ConvolutionLink<float>>&);
template Field convolve_to_sum(const std::vector<const Field*>&, const std::vector<ConvolutionLink<float>>&);

}  // namespace holotrace
