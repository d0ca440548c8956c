#pragma once

#include <complex>
#include <string>
#include <vector>

#include "holotrace/base/array.h"

namespace holotrace {

/// Fills a file with a complex array in NumPy's format 1.0, C order, little endian.
/// Reference: numpy.lib.format (NEP 1).
template <class Real>
void write_npy(const std::string& path, const Array2D<std::complex<Real>>& values);

/// Reads complex64 or complex128, shape (ny, nx) or (1, ny, nx), C order.
/// @throws Error naming the file for any other content, and for a file too short for its shape
template <class Real>
Array2D<std::complex<Real>> read_npy(const std::string& path);

}  // namespace holotrace
