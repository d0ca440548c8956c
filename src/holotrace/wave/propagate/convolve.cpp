#include "holotrace/wave/propagate/convolve.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <complex>
#include <optional>
#include <utility>
#include <vector>

#include "holotrace/base/column_fft.h"
#include "holotrace/base/complex_arrays.h"
#include "holotrace/base/error.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/threads.h"

namespace holotrace {

double convolution_bytes(const PropagationAxis& x, const PropagationAxis& y, size_t bytes_per_real) {
  const double columns = double(x.frequencies()) / x.parts + column_block;
  return 2.0 * double(bytes_per_real) * (columns * std::max(y.inputs, y.outputs) + double(x.outputs) * y.outputs);
}

namespace {

/// One field to one or several, or several fields to one, which is their sum. Input i is in blocks[i], and output o is
/// left in blocks[o].
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
        forward_x_(p_.x.part_length(), FftDirection::forward),
        backward_x_(p_.x.part_length(), FftDirection::backward),
        along_y_(p_.y.part_length()) {
    for (int part = 0; part < p_.y.parts; ++part) parts_y_.emplace_back(p_.y, part, 1);
    for (const ConvolutionLink<Real>& link : links)
      ramps_y_.push_back(displacement_ramp<Real>(p_.y, link.shift_y, p_.y.padded, [&](int slot) {
        const int length = p_.y.part_length();
        return signed_frequency(slot / length + slot % length * p_.y.parts, p_.y.padded);
      }));
  }

  /// @param observer  of the whole work: large fields take seconds, and a caller may want to stop
  void run(int part, std::vector<ColumnBlocks<Real>>& blocks, const Observer& observer) {
    const int loops = int(fields_.size() + 1 + out_.size());
    int loop = part * loops;
    const auto next = [&] { return part_of(observer, loop++, p_.x.parts * loops); };
    const AxisPart<Real> x(p_.x, part, 1.0 / (double(p_.x.padded) * p_.y.padded));
    const int count = ColumnBlocks<Real>::blocks_of(x.columns);
    ramps_x_.clear();
    for (const ConvolutionLink<Real>& link : links_)
      ramps_x_.push_back(
          displacement_ramp<Real>(p_.x, link.shift_x, x.columns, [&](int column) { return x.frequency(column); }));
    std::vector<double> of_rows(size_t(p_.y.inputs)), of_blocks(static_cast<size_t>(count));
    for (size_t i = 0; i < fields_.size(); ++i)
      parallel_for(
          0, p_.y.inputs, [&](int64_t j) { of_rows[size_t(j)] = forward_row(x, i, int(j), blocks[i]); }, next(), 8);
    parallel_for(
        0, count, [&](int64_t b) { of_blocks[size_t(b)] = filter_columns(x, int(b), blocks); }, next());
    for (size_t o = 0; o < out_.size(); ++o)
      parallel_for(
          0, p_.y.outputs, [&](int64_t row) { backward_row(x, o, int(row), blocks[o]); }, next(), 8);
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
  static void move_row(ColumnBlocks<Real>& blocks, int row, int column, int end, Complex* line) {
    for (; column < end; ++column, ++line) {
      Complex* held = blocks.at(column / column_block, row) + column % column_block;
      Complex* to = into == Into::blocks ? held : line;
      const Complex* from = into == Into::blocks ? line : held;
      if (column % column_block == 0 && column + column_block <= end) {
        copy_block(from, to);
        column += column_block - 1;
        line += column_block - 1;
      } else {
        *to = *from;
      }
    }
  }

  // The frequencies in use of a row are at bins + bin(0) … for those below zero, and at bins + bin(below) … for the
  // rest. Multiplies them by a ramp.
  static void multiply_bins(const AxisPart<Real>& x, const std::vector<Complex>& ramp, Complex* bins) {
    if (ramp.empty()) return;
    const int below = x.below_zero();
    if (below > 0) multiply(bins + x.bin(0), bins + x.bin(0), ramp.data(), size_t(below));
    if (below < x.columns)
      multiply(bins + x.bin(below), bins + x.bin(below), ramp.data() + below, size_t(x.columns - below));
  }

  // Transforms along x and stores the frequencies in use in their blocks.
  double forward_row(const AxisPart<Real>& x, size_t input, int j, ColumnBlocks<Real>& blocks) const {
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
    if (x.columns % column_block != 0) {  // the rest of the last block is transformed too, and must be finite
      Complex* last = blocks.at(x.columns / column_block, j);
      std::fill(last + x.columns % column_block, last + column_block, Complex());
    }
    return dropped;
  }

  double held_energy(const AxisPart<Real>& x, const Complex* bins) const {
    const int below = x.below_zero();
    return (below > 0 ? energy(bins + x.bin(0), size_t(below)) : 0) +
           (below < x.columns ? energy(bins + x.bin(below), size_t(x.columns - below)) : 0);
  }

  // Transforms along y, filters, and transforms back, in the cache. The first part is done last: it can use the blocks
  // themselves.
  double filter_columns(const AxisPart<Real>& x, int b, std::vector<ColumnBlocks<Real>>& blocks) {
    const int length = p_.y.part_length(), parts = p_.y.parts;
    const size_t size = size_t(length) * column_block, outputs = out_.size();
    AlignedVector<Complex>& work = work_.local();
    work.resize(size * (size_t(parts) * outputs + 3));
    Complex* spectrum = work.data() + size * size_t(parts) * outputs;
    Complex* filtered = outputs > 1 || fields_.size() > 1 ? spectrum + size : spectrum;
    Complex* spare = spectrum + 2 * size;
    const auto rows = [&](size_t output, int part) {
      return work.data() + size * (output * size_t(parts) + size_t(part));
    };
    double dropped = 0;
    for (int part = parts - 1; part >= 0; --part) {
      const bool enters_whole = part == 0 && p_.y.inputs == length;
      const bool leaves_whole = part == 0 && p_.y.outputs == length && p_.y.shift == 0;
      for (size_t i = 0; i < fields_.size(); ++i) {
        if (!enters_whole) enter_part(parts_y_[size_t(part)], b, blocks[i], rows(0, part));
        along_y_(FftDirection::forward, enters_whole ? blocks[i].at(b, 0) : rows(0, part), spectrum, spare);
        dropped += dropped_energy(part, spectrum);
        if (has_many_inputs()) {
          filter(x, b, part, i, i > 0, spectrum, filtered);
          continue;
        }
        for (size_t o = 0; o < outputs; ++o) {
          filter(x, b, part, o, false, spectrum, filtered);
          along_y_(FftDirection::backward, filtered, leaves_whole ? blocks[o].at(b, 0) : rows(o, part), spare);
        }
      }
      if (has_many_inputs())
        along_y_(FftDirection::backward, filtered, leaves_whole ? blocks[0].at(b, 0) : rows(0, part), spare);
      if (part == 0 && !leaves_whole)
        for (size_t o = 0; o < outputs; ++o) leave_part(parts_y_[0], b, blocks[o], rows(o, 0));
    }
    for (size_t o = 0; o < outputs; ++o)
      for (int part = 1; part < parts; ++part) leave_part(parts_y_[size_t(part)], b, blocks[o], rows(o, part));
    return dropped;
  }

  // to = spectrum · transfer function of a link, or to += that.
  void filter(const AxisPart<Real>& x, int b, int part, size_t link, bool adds, Complex* spectrum, Complex* to) const {
    const int length = p_.y.part_length(), from = part * length;
    const Propagator<Real>& p = *links_[link].propagator;
    const Complex* ramp = ramps_y_[link].empty() ? nullptr : ramps_y_[link].data() + from;
    if (adds && ramp) multiply_rows(spectrum, spectrum, ramp, size_t(length), column_block);  // no other link needs it
    constexpr int step = 32;  // factors that stay in the first cache
    alignas(64) std::array<Complex, size_t(step) * column_block> h;
    for (int first = 0; first < length; first += step) {
      const int count = std::min(step, length - first);
      std::array<const Complex*, column_block> columns;
      for (int c = 0; c < column_block; ++c) {
        const int column = std::min(b * column_block + c, x.columns - 1);  // beyond the last one, the spectrum is 0
        columns[size_t(c)] = p.transfer.row(p.x.slot(x.frequency(column))) + from + first;
      }
      turn_to_rows(columns, count, h.data());
      const size_t samples = size_t(count) * column_block;
      const Complex* source = spectrum + first * column_block;
      Complex* result = to + first * column_block;
      if (links_[link].is_adjoint)
        adds ? multiply_conjugate_add(result, source, h.data(), samples)
             : multiply_conjugate(result, source, h.data(), samples);
      else
        adds ? multiply_add(result, source, h.data(), samples) : multiply(result, source, h.data(), samples);
    }
    if (!adds && ramp) multiply_rows(to, to, ramp, size_t(length), column_block);
  }

  void enter_part(const AxisPart<Real>& y, int b, ColumnBlocks<Real>& blocks, Complex* rows) const {
    for (int j = 0; j < p_.y.inputs; j += y.length) {
      const int count = std::min(y.length, p_.y.inputs - j);
      if (j == 0 && y.part == 0)
        std::copy_n(blocks.at(b, 0), count * column_block, rows);
      else if (j == 0)
        multiply_rows(rows, blocks.at(b, 0), y.enter.data(), size_t(count), column_block);
      else
        multiply_add_rows(rows, blocks.at(b, j), y.enter.data() + j, size_t(count), column_block);
    }
    if (p_.y.inputs < y.length) std::fill(rows + p_.y.inputs * column_block, rows + y.length * column_block, Complex());
  }

  void leave_part(const AxisPart<Real>& y, int b, ColumnBlocks<Real>& blocks, const Complex* rows) const {
    y.each_run_of_outputs([&](int o, int at, int count) {
      if (y.part == 0)
        std::copy_n(rows + at * column_block, count * column_block, blocks.at(b, o));
      else
        multiply_add_rows(blocks.at(b, o), rows + at * column_block, y.leave.data() + o, size_t(count), column_block);
    });
  }

  // Energy of the frequencies last + 1 … padded + first − 1 of y in this part.
  double dropped_energy(int part, const Complex* spectrum) const {
    const PropagationAxis& y = p_.y;
    const int from = y.last + 1 + wrapped(part - y.last - 1, y.parts);
    const int to = y.padded + y.first;
    if (from >= to) return 0;
    const int count = (to - from + y.parts - 1) / y.parts;
    if (y.last >= 0 && y.first <= 0)
      return energy(spectrum + from / y.parts * column_block, size_t(count) * column_block);
    double sum = 0;  // if the band lies to one side of zero, the dropped frequencies wrap around
    for (int n = 0; n < count; ++n)
      sum += energy(spectrum + wrapped(from + n * y.parts, y.padded) / y.parts * column_block, column_block);
    return sum;
  }

  // Transforms back along x and adds the result to the outputs.
  void backward_row(const AxisPart<Real>& x, size_t output, int o, ColumnBlocks<Real>& blocks) {
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
  const Fft<Real> forward_x_, backward_x_;
  const ColumnFft<Real> along_y_;
  std::vector<AxisPart<Real>> parts_y_;
  std::vector<std::vector<Complex>> ramps_x_, ramps_y_;           // of each link; ramps_x_ for the part of x at work
  tbb::enumerable_thread_specific<AlignedVector<Complex>> work_;  // work space per thread, for its current block
};

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
  std::vector<ColumnBlocks<Real>> blocks;
  for (size_t i = 0; i < links.size(); ++i) blocks.emplace_back(most, std::max(p.y.inputs, p.y.outputs));
  for (int part = 0; part < p.x.parts; ++part) convolution.run(part, blocks, observer);
  return convolution.is_band_limited() ? std::optional(convolution.dropped_part()) : std::nullopt;
}

template <class Real>
BasicField<Real> output_of(const ConvolutionLink<Real>& link, double wavelength, double z) {
  const Propagator<Real>& p = *link.propagator;
  auto out = BasicField<Real>::unset(p.output, wavelength, z + (link.is_adjoint ? -p.distance : p.distance));
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
  out.push_back(BasicField<Real>::unset(links.front().propagator->output, fields.front()->wavelength));
  run_links<Real>(fields, links, out, {});
  return std::move(out.front());
}

template Field convolve(const Field&, const Propagator<float>&, const Observer&);
template FieldDouble convolve(const FieldDouble&, const Propagator<double>&, const Observer&);
template std::vector<Field> convolve_to_many(const Field&, const std::vector<ConvolutionLink<float>>&);
template Field convolve_to_sum(const std::vector<const Field*>&, const std::vector<ConvolutionLink<float>>&);

}  // namespace holotrace
