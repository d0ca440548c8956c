#pragma once

#include <complex>
#include <string>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/io/files/new_file.h"

namespace holotrace {

/// Fills a file with complex arrays of one size in NumPy's format 1.0, C order, little endian: shape (ny, nx) for one
/// array, (count, ny, nx) for several.
/// Reference: numpy.lib.format (NEP 1).
template <class Real>
void write_npy(NewFile& file, const std::vector<const Array2D<std::complex<Real>>*>& stack);

/// Reads complex64 or complex128, shape (ny, nx) or (count, ny, nx), in C order or in Fortran order (which NumPy writes
/// for an array that was transposed).
/// @throws Error naming the file for any other content, and for a file that is too short for its shape
template <class Real>
std::vector<Array2D<std::complex<Real>>> read_npy(const std::string& path);

}  // namespace holotrace
