#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "holotrace/base/aligned_memory.h"

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

  /// An array whose values are anything until they are set: for large ones that threads fill together, because the first
  /// access to memory may take longer than all that follows.
  static Array2D unset(int ny, int nx) {
    Array2D array;
    array.ny = ny;
    array.nx = nx;
    array.values = AlignedVector<T>(size_t(ny) * size_t(nx), AlignedAllocator<T>::without_zeros());
    return array;
  }

  T* row(int j) { return values.data() + size_t(j) * size_t(nx); }
  const T* row(int j) const { return values.data() + size_t(j) * size_t(nx); }
  T& operator()(int j, int i) { return row(j)[i]; }
  const T& operator()(int j, int i) const { return row(j)[i]; }
  size_t size() const { return values.size(); }
};

}  // namespace holotrace
