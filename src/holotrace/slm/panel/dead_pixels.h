#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/data/slm.h"

namespace holotrace {

/// A pixel, by its index row·nx + column, that always shows the same level of the panel.
struct StuckPixel {
  int64_t pixel = 0;
  int level = 0;
};

/// All dead pixels of a panel, by index, each once: those that the panel lists, and every other pixel with probability
/// `dead_fraction`, at a uniformly random level. Pixel i draws from the counter (dead_seed, i): the same on any thread.
std::vector<StuckPixel> stuck_pixels(const Slm& slm);

}  // namespace holotrace
