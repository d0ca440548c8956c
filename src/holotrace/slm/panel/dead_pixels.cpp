#include "holotrace/slm/panel/dead_pixels.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"

namespace holotrace {

std::vector<StuckPixel> stuck_pixels(const Slm& slm) {
  const SlmEffects& effects = slm.effects;
  const int nx = slm.grid.nx;
  std::vector<std::vector<StuckPixel>> rows(size_t(slm.grid.ny));
  if (effects.dead_fraction > 0)
    parallel_for(0, slm.grid.ny, [&](int64_t j) {
      for (int i = 0; i < nx; ++i) {
        CounterRandom random(uint64_t(effects.dead_seed), 0, uint64_t(j * nx + i));
        if (random.uniform() < effects.dead_fraction)
          rows[size_t(j)].push_back({j * nx + i, int(random.uniform() * slm.levels)});
      }
    });
  std::map<int64_t, int> level_of;
  for (const auto& row : rows)
    for (const StuckPixel& pixel : row) level_of[pixel.pixel] = pixel.level;
  for (const DeadPixel& pixel : effects.dead_pixels) level_of[int64_t(pixel.row) * nx + pixel.column] = pixel.level;
  std::vector<StuckPixel> all;
  all.reserve(level_of.size());
  for (const auto& [pixel, level] : level_of) all.push_back({pixel, level});
  return all;
}

}  // namespace holotrace
