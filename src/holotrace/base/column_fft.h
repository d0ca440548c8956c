#pragma once

#include <complex>
#include <cstddef>
#include <cstring>

#include "holotrace/base/fft.h"
#include "holotrace/base/fft_stages.h"

// Blocks of columns that lie side by side, as transforms along columns take them: sample i of column c is at [i][c].

namespace holotrace {

/// A copy of known size, which the compiler can keep in registers.
template <class Real>
void copy_block(const std::complex<Real>* from, std::complex<Real>* to) {
  std::memcpy(static_cast<void*>(to), from, column_block * sizeof(*from));
}

/// Transforms of a block of columns that lie side by side, before and after. The columns are the lanes of vectors, so that
/// no sample changes its lane. Tables are made once for each length and kept for the life of the program.
template <class Real>
class ColumnFft {
 public:
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
  const FftStages<Real>* stages_ = nullptr;   // if the length has them
  const ChirpTables<Real>* chirp_ = nullptr;  // otherwise
};

}  // namespace holotrace
