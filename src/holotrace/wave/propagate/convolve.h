#pragma once

#include <algorithm>
#include <complex>
#include <cstdint>
#include <vector>

#include "holotrace/base/column_fft.h"
#include "holotrace/base/cycles.h"
#include "holotrace/base/fft.h"
#include "holotrace/base/large_buffer.h"
#include "holotrace/wave/propagate/propagation_axis.h"
#include "holotrace/wave/propagate/propagator.h"

// The parts of a padded transform, and the blocks of columns that hold one part.

namespace holotrace {

/// The least frequency k ≡ part modulo axis.parts that is in use, and the number of them.
struct PartFrequencies {
  int first, count;
};

inline PartFrequencies part_frequencies(const PropagationAxis& axis, int part) {
  const int first = axis.first + wrapped(part - axis.first, axis.parts);
  return {first, first <= axis.last ? (axis.last - first) / axis.parts + 1 : 0};
}

/// One part of one axis: the frequencies k ≡ part modulo axis.parts.
template <class Real>
struct AxisPart {
  using Complex = std::complex<Real>;
  const PropagationAxis& axis;
  int part, length, columns;  // columns: number of frequencies in use
  int first;                  // the least of them
  std::vector<Complex> enter, leave;

  AxisPart(const PropagationAxis& a, int part, double scale)
      : axis(a),
        part(part),
        length(a.part_length()),
        columns(part_frequencies(a, part).count),
        first(part_frequencies(a, part).first),
        enter(size_t(a.inputs)),
        leave(size_t(a.outputs)) {
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

/// Blocks of columns for a part of the spectrum along x: [block][row][column in block].
template <class Real>
struct ColumnBlocks {
  int rows;
  LargeBuffer<std::complex<Real>> values;

  ColumnBlocks(int columns, int rows) : rows(rows), values(size_t(blocks_of(columns)) * size_t(rows) * column_block) {}
  static int blocks_of(int columns) { return (columns + column_block - 1) / column_block; }
  std::complex<Real>* at(int b, int row) {
    return values.data() + (size_t(b) * size_t(rows) + size_t(row)) * column_block;
  }
};

/// exp(2πi·k·shift/padded) for the frequencies k of an axis, which displaces samples by `shift`; empty for 0.
/// `frequency(i)` is that of slot i, between −padded/2 and padded/2.
template <class Real, class Frequency>
std::vector<std::complex<Real>> displacement_ramp(const PropagationAxis& axis, double shift, int slots,
                                                  const Frequency& frequency) {
  std::vector<std::complex<Real>> values(shift == 0 ? 0 : size_t(slots));
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = std::complex<Real>(cis_cycles(double(frequency(int(i))) * shift / axis.padded));
  return values;
}

/// A field through a propagator on a lattice: all outputs have the same offset s from an input sample.
///
///     out(o) = 1/XY·Σ_{k,l} H(k, l)·û(k, l)·exp(i2π(k(o + s)/X + l(o′ + s′)/Y))
///
/// The field padded to twice its length has a spectrum of two parts, even and odd k. The odd part is the transform of
/// the field times exp(−iπn/N). Each part has half of the samples, and none of them is padding. Along x the parts are
/// done one after the other, so only half of a padded row is held at a time, in blocks of few columns. Along y a block
/// is transformed, multiplied and transformed back while it is in the cache.
///
/// Fact: `energy_beyond_band`, the fraction of the light that the band limit drops.
template <class Real>
BasicField<Real> convolve(const BasicField<Real>& field, const Propagator<Real>& propagator, const Observer& observer);

/// One of several propagations that share transforms. Their propagators have the same windows and the same band.
template <class Real>
struct ConvolutionLink {
  const Propagator<Real>* propagator = nullptr;
  bool is_adjoint = false;  ///< the adjoint of the propagator, whose windows must be equal (propagator.h)
  /// Displacement of the output's samples, right and down [samples]; for an adjoint minus that of its input's samples.
  double shift_x = 0, shift_y = 0;
};

/// One field through several propagations: Σ of 1 + n transforms instead of 2n. A displaced window has samples between
/// those of the other windows; for a field that is limited to its band, they are exact.
template <class Real>
std::vector<BasicField<Real>> convolve_to_many(const BasicField<Real>& field,
                                               const std::vector<ConvolutionLink<Real>>& links);

/// The sum of several fields, each through its own propagation: Σᵢ Tᵢ·fieldᵢ, in n + 1 transforms.
template <class Real>
BasicField<Real> convolve_to_sum(const std::vector<const BasicField<Real>*>& fields,
                                 const std::vector<ConvolutionLink<Real>>& links);

/// Bytes that convolve needs beside the field and the propagator, including its result.
double convolution_bytes(const PropagationAxis& x, const PropagationAxis& y, size_t bytes_per_real);

}  // namespace holotrace
