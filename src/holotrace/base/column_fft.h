#pragma once

#include <algorithm>
#include <array>
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

/// columns[c][i] = rows[i][c], for the `count` samples of each column of a block.
template <class Real>
void turn_to_columns(const std::complex<Real>* rows, int count, std::complex<Real>* columns) {
  alignas(64) std::array<std::complex<Real>, size_t(column_block) * column_block> square;
  for (int first = 0; first < count; first += column_block) {
    std::array<const std::complex<Real>*, column_block> from;
    for (int i = 0; i < column_block; ++i) from[size_t(i)] = rows + std::min(first + i, count - 1) * column_block;
    turn_to_rows(from, column_block, square.data());
    for (int c = 0; c < column_block; ++c)
      std::copy_n(square.data() + c * column_block, std::min(column_block, count - first),
                  columns + size_t(c) * size_t(count) + first);
  }
}

/// Transforms of a block of columns that lie side by side, before and after. The columns are the lanes of vectors, so that
/// no sample changes its lane. Tables are made once for each length and kept for the life of the program. A length with
/// other factors than 2 to 13 takes 48 complex numbers for each sample of its padded convolution besides, which each thread keeps.
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
