#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/base/array.h"

namespace holotrace {

/// The values that are sent to a panel, without what they mean: greys, levels, or what a vendor's table makes of them.
struct PanelImage {
  int columns = 0, rows = 0, channels = 1;  ///< channels: 1, or 3 for red, green and blue
  int bits = 8;                             ///< 8 or 16
  std::vector<uint16_t> values{};           ///< [row][column][channel]
};

/// What the values of a picture for a panel count, before the maker's level table.
enum class PanelValue { grey, level };

/// What the maker of a panel gives with it.
struct PanelTables {
  std::vector<uint16_t> lut{};  ///< value that is sent for each grey or level; empty: the grey or level itself
  Array2D<float>
      correction{};  ///< phase that is added [cycles], a value for each pixel as the panel has it; empty: none
};

}  // namespace holotrace
