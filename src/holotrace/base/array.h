#pragma once

#include <complex>
#include <cstddef>
#include <cstring>
#include <vector>

#include "holotrace/base/aligned_memory.h"
#include "holotrace/base/sanitizers.h"

namespace holotrace {

/// A contiguous buffer aligned for vectors, on huge pages if it is large.
template <class T>
using AlignedVector = std::vector<T, AlignedAllocator<T>>;

/// Values of a panel or an image: row-major [row][column], row 0 on top.
template <class T>
struct Array2D {
  int ny = 0, nx = 0;
  AlignedVector<T> values;

  Array2D() = default;
  Array2D(int ny, int nx, T value = T()) : ny(ny), nx(nx), values(size_t(ny) * size_t(nx), value) {}

  /// An array whose values are anything until they are set; every value must be written before it is read. For large arrays that
  /// threads fill together, because the first access to memory may take longer than all that follows. Under the address
  /// sanitizer floats are NaN.
  static Array2D unset(int ny, int nx) {
    Array2D array;
    array.ny = ny;
    array.nx = nx;
    array.values = AlignedVector<T>(size_t(ny) * size_t(nx), AlignedAllocator<T>::without_zeros());
    if (HOLOTRACE_ADDRESS_SANITIZER && array.size() > 0)
      std::memset(static_cast<void*>(array.values.data()), 0xFF, array.size() * sizeof(T));
    return array;
  }

  T* row(int j) { return values.data() + size_t(j) * size_t(nx); }
  const T* row(int j) const { return values.data() + size_t(j) * size_t(nx); }
  T& operator()(int j, int i) { return row(j)[i]; }
  const T& operator()(int j, int i) const { return row(j)[i]; }
  size_t size() const { return values.size(); }
};

}  // namespace holotrace
