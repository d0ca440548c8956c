#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <complex>
#include <initializer_list>

#include "holotrace/base/array.h"
#include "holotrace/base/error.h"

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

/// The index of the first value that is not finite; `count` if all are. On all threads, without the GIL.
size_t first_not_finite(const float* values, size_t count);
size_t first_not_finite(const double* values, size_t count);
template <class Real>
size_t first_not_finite(const std::complex<Real>* values, size_t count) {
  return first_not_finite(reinterpret_cast<const Real*>(values), 2 * count) / 2;
}
inline size_t first_not_finite(const uint16_t*, size_t count) { return count; }

/// @param columns  length of a row
/// @throws Error  for a value that is not finite, naming its place
template <class T>
void check_finite(const T* values, size_t count, size_t columns, const char* what) {
  const size_t bad = first_not_finite(values, count);
  if (bad < count)
    fail("expected finite numbers in {}, got NaN or infinity at row {}, column {}", what, bad / columns, bad % columns);
}

/// A copy of an array of two dimensions. @throws Error  as check_finite, and for an array without values
template <class T>
Array2D<T> to_array(const In2<T>& from, const char* what) {
  require(from.size() > 0, "expected rows and columns in {}, got an array of the shape ({}, {})", what, from.shape(0),
          from.shape(1));
  Array2D<T> array;
  array.ny = int(from.shape(0));
  array.nx = int(from.shape(1));
  const nb::gil_scoped_release release;
  array.values.assign(from.data(), from.data() + from.size());
  check_finite(array.values.data(), array.size(), size_t(array.nx), what);
  return array;
}

template <class T>
nb::object view(nb::handle owner, const Array2D<T>& array) {
  return view(owner, array.values.data(), {size_t(array.ny), size_t(array.nx)});
}

}  // namespace holotrace::python
