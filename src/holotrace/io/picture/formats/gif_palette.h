#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace holotrace {

/// A picture by at most 256 colours.
struct IndexedPicture {
  std::vector<std::array<uint8_t, 3>> palette;  ///< 1 to 256 colours R, G, B
  std::vector<uint8_t> indices;                 ///< [row][column]
};

/// The picture by a palette of its own: exactly, if it has at most 256 colours. Otherwise the colours come from median
/// cuts of the picture's colours (P. Heckbert, SIGGRAPH 1982), and the rest of each pixel is passed on to its
/// neighbours (Floyd and Steinberg, 1976).
/// @param colours  [row][column][R, G, B]
IndexedPicture with_palette(const std::vector<uint8_t>& colours, int columns, int rows);

}  // namespace holotrace
