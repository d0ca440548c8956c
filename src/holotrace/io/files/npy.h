#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

// Headers of NumPy's files .npy. Reference: numpy.lib.format (NEP 1).

namespace holotrace {

struct NpyHeader {
  std::string dtype;           ///< such as "<c8"
  bool fortran_order = false;  ///< whether the first index varies fastest, as NumPy writes arrays that were transposed
  std::vector<int64_t> shape;
  size_t data_begin = 0;  ///< place of the samples in the file [bytes]
};

/// @throws Error naming the file if it is not a .npy of format 1, 2 or 3, or is truncated in its header
NpyHeader read_npy_header(const std::string& bytes, const std::string& path);

/// The bytes before the samples of an array in C order, in format 1.0; the samples begin at a multiple of 64 bytes.
std::string npy_header(const char* dtype, const std::vector<int64_t>& shape);

/// A shape as NumPy writes it: "(3, 1080, 1920)".
std::string format_shape(const std::vector<int64_t>& shape);

}  // namespace holotrace
