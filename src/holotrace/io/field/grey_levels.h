#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/slm.h"

// Levels as the greys of a PNG (hologram_file.h has the formula), and the text inside it. Only hologram_file.cpp uses it.

namespace holotrace {

/// The text of a PNG that holds the metadata of a hologram.
constexpr const char* metadata_name = "holotrace";

struct Greys {
  int nx = 0, ny = 0, bits = 8;
  std::string metadata;          ///< empty if the file has none
  std::vector<uint16_t> values;  ///< [row][column]
};

/// The grey of a level, in 8 or 16 bits.
uint16_t grey_of(uint16_t level, int levels, Modulation modulation, int bits);

/// @throws Error naming the file if it is not a grey image of 8 or 16 bits, or is truncated
Greys read_greys(const std::string& path);

/// Writes levels as greys. @throws Error for a level that is not below `levels`, and where NewFile throws
void write_greys(const std::string& path, const Array2D<uint16_t>& levels_of_pixels, int levels, Modulation modulation,
                 const std::string& metadata = "");

/// The levels that greys mean.
/// @param source  file with the number of levels, for errors
/// @throws Error naming `path` for a grey that is no level
Array2D<uint16_t> levels_of(const Greys& greys, int levels, Modulation modulation, const std::string& path,
                            const std::string& source);

}  // namespace holotrace
