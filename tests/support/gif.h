#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace holotrace::test {

/// An animated GIF as giflib reads it.
struct Gif {
  int nx = 0, ny = 0;
  int loops = -1;                            ///< 0: without end; -1: the file does not say
  int hundredths = -1;                       ///< duration of the first frame [1/100 s]
  std::vector<std::vector<uint8_t>> frames;  ///< [row][column][R, G, B]
};

/// @return no frames if the file is not a whole GIF
Gif load_gif(const std::string& path);

}  // namespace holotrace::test
