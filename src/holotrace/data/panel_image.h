#pragma once

#include <cstdint>
#include <vector>

namespace holotrace {

/// The values that are sent to a panel, without what they mean: greys, levels, or what a vendor's table makes of them.
struct PanelImage {
  int columns = 0, rows = 0, channels = 1;  ///< channels: 1, or 3 for red, green and blue
  int bits = 8;                             ///< 8 or 16
  std::vector<uint16_t> values{};           ///< [row][column][channel]
};

}  // namespace holotrace
