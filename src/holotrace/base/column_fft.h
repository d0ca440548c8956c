#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/column_blocks.h"
#include "holotrace/base/fft.h"

namespace holotrace {

/// Transforms of a block of columns that lie side by side (column_blocks.h), before and after. The columns are
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
