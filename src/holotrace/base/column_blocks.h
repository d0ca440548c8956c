#pragma once

#include <algorithm>
#include <array>
#include <complex>
#include <cstddef>
#include <cstring>

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

}  // namespace holotrace
