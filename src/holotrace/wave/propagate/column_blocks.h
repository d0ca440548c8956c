#pragma once

#include <algorithm>
#include <complex>
#include <cstddef>
#include <cstring>

// Blocks of columns of a field, as the transforms of propagation handle them.

namespace holotrace {

/// Columns stored side by side: whole cache lines in either precision.
constexpr int block = 16;

/// A copy of known size, which the compiler can keep in registers.
template <class Real>
void copy_block(const std::complex<Real>* from, std::complex<Real>* to) {
  std::memcpy(static_cast<void*>(to), from, block * sizeof(*from));
}

/// Transposes the columns of a block, stored one after the other, to rows.
template <class Real>
void turn_to_rows(const std::complex<Real>* columns, int length, std::complex<Real>* rows) {
  constexpr int step = 8;  // a cache line of each column at a time
  for (int first = 0; first < length; first += step) {
    const int count = std::min(step, length - first);
    for (int c = 0; c < block; ++c) {
      const std::complex<Real>* from = columns + size_t(c) * size_t(length) + first;
      std::complex<Real>* to = rows + size_t(first) * block + c;
      if (count == step)
        for (int j = 0; j < step; ++j) to[j * block] = from[j];
      else
        for (int j = 0; j < count; ++j) to[j * block] = from[j];
    }
  }
}

}  // namespace holotrace
