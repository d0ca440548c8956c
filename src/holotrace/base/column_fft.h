#pragma once

#include <algorithm>
#include <array>
#include <complex>
#include <cstddef>
#include <cstring>
#include <optional>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/fft.h"

// Blocks of columns that lie side by side, as transforms along columns take them: sample i of column c is at [i][c].

namespace holotrace {

/// Columns of a block: whole cache lines in either precision.
constexpr int column_block = 16;

/// A copy of known size, which the compiler can keep in registers.
template <class Real>
void copy_block(const std::complex<Real>* from, std::complex<Real>* to) {
  std::memcpy(static_cast<void*>(to), from, column_block * sizeof(*from));
}

/// rows[i][c] = columns[c][i], for `count` samples of each column of a block.
template <class Real>
void turn_to_rows(const std::array<const std::complex<Real>*, column_block>& columns, int count,
                  std::complex<Real>* rows) {
  constexpr int step = 8;  // a cache line of each column at a time
  for (int first = 0; first < count; first += step, rows += step * column_block) {
    const int samples = std::min(step, count - first);
    for (int c = 0; c < column_block; ++c) {
      const std::complex<Real>* from = columns[size_t(c)] + first;
      if (samples == step)
        for (int i = 0; i < step; ++i) rows[i * column_block + c] = from[i];
      else
        for (int i = 0; i < samples; ++i) rows[i * column_block + c] = from[i];
    }
  }
}

/// Transforms of a block of columns that lie side by side, before and after. The columns are
/// the lanes of vectors, so that no sample changes its lane. It needs no planning by measurement, and is about twice as
/// fast as FFTW from columns to columns.
///
/// Lengths with the factors 2, 3 and 5 are transformed by stages of radix 2 to 8 that leave their output in order
/// (Stockham; Van Loan, Computational Frameworks for the Fast Fourier Transform, 1992, section 1.7). FFTW transforms
/// others, and lengths of one stage.
template <class Real>
class ColumnFft {
 public:
  /// A step: transforms of `radix` samples, `groups` times for each of `inner` neighbours, with twiddle factors from
  /// twiddles[first_twiddle] on.
  struct Stage {
    int radix, groups, inner;
    size_t first_twiddle;
  };

  /// @throws Error unless length ≥ 1.
  explicit ColumnFft(int length);

  int length() const { return length_; }
  /// Samples that `work` has.
  size_t work_size() const { return size_t(length_) * column_block; }

  /// Neither direction scales. The three arrays do not overlap, and are aligned to 64 bytes. The input is not changed.
  void operator()(FftDirection direction, const std::complex<Real>* input, std::complex<Real>* output,
                  std::complex<Real>* work) const;

 private:
  int length_;
  std::vector<Stage> stages_;                         // two or more, in their order; none if FFTW does it
  AlignedVector<std::complex<Real>> twiddles_;        // of each stage, [group][1 … radix − 1]
  std::optional<FftBatch<Real>> forward_, backward_;  // of FFTW, if it transforms this length
};

}  // namespace holotrace
