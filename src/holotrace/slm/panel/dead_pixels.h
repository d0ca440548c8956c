#pragma once

#include <cstdint>
#include <vector>

#include "holotrace/data/slm.h"

namespace holotrace {

/// A pixel that is stuck, by its index row·nx + column, at a level of the panel.
struct StuckPixel {
  int64_t pixel = 0;
  int level = 0;
};

/// All dead pixels of a panel, by index, each once: those it lists, and each other one with the chance `dead_fraction`,
/// at an even random level. Pixel i draws from the counter (dead_seed, i): the same on any thread.
std::vector<StuckPixel> stuck_pixels(const Slm& slm);

}  // namespace holotrace
