#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <complex>
#include <cstring>
#include <initializer_list>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"

// Arrays between NumPy and the library. NumPy sees the memory of a noun: `view` makes no copy, and keeps the noun alive.
// The other way makes one copy, because a noun owns its memory.

namespace holotrace::python {

namespace nb = nanobind;

/// Row-major arrays in the CPU's memory. The Python side makes others, such as transposed ones, so.
template <class T>
using In1 = nb::ndarray<const T, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <class T>
using In2 = nb::ndarray<const T, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
template <class T>
using In3 = nb::ndarray<const T, nb::ndim<3>, nb::c_contig, nb::device::cpu>;

/// An array of NumPy on the memory of `owner`. @param strides  in values; none: row-major
template <class T>
nb::object view(nb::handle owner, const T* data, std::initializer_list<size_t> shape,
                std::initializer_list<int64_t> strides = {}) {
  return nb::cast(nb::ndarray<nb::numpy, T>(const_cast<T*>(data), shape, owner, strides), nb::rv_policy::reference);
}

inline bool is_finite(float value) { return std::isfinite(value); }
inline bool is_finite(double value) { return std::isfinite(value); }
template <class Real>
bool is_finite(const std::complex<Real>& value) {
  return std::isfinite(value.real()) && std::isfinite(value.imag());
}
inline bool is_finite(uint16_t) { return true; }

/// Copies values, on all threads and without the GIL. `columns` is the length of a row, for the message.
/// @throws Error  for a value that is not finite, naming its place
template <class T>
void copy_checked(const T* from, size_t count, size_t columns, const char* what, T* to) {
  constexpr size_t piece = size_t(1) << 16;
  std::atomic<size_t> bad{count};
  {
    const nb::gil_scoped_release release;
    parallel_for(0, int64_t((count + piece - 1) / piece), [&](int64_t p) {
      const size_t first = size_t(p) * piece, end = std::min(first + piece, count);
      std::copy(from + first, from + end, to + first);
      bool is_sound = true;
      for (size_t i = first; i < end; ++i) is_sound &= is_finite(from[i]);
      for (size_t i = first; !is_sound && i < end; ++i)
        if (!is_finite(from[i])) {
          size_t seen = bad;
          while (i < seen && !bad.compare_exchange_weak(seen, i)) {
          }
          break;
        }
    });
  }
  if (bad < count)
    fail("expected finite numbers in {}, got NaN or infinity at row {}, column {}", what, bad / columns, bad % columns);
}

/// A copy of an array of two dimensions. @throws Error  as copy_checked, and for an array without values
template <class T>
Array2D<T> to_array(const In2<T>& from, const char* what) {
  require(from.size() > 0, "expected rows and columns in {}, got an array of the shape ({}, {})", what, from.shape(0),
          from.shape(1));
  Array2D<T> array;
  array.ny = int(from.shape(0));
  array.nx = int(from.shape(1));
  array.values.resize(from.size());
  copy_checked(from.data(), from.size(), from.shape(1), what, array.values.data());
  return array;
}

template <class T>
nb::object view(nb::handle owner, const Array2D<T>& array) {
  return view(owner, array.values.data(), {size_t(array.ny), size_t(array.nx)});
}

}  // namespace holotrace::python
