#include "holotrace/data/sources.h"

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"

namespace holotrace {

double random_phase(uint64_t seed, uint32_t frame, uint64_t key) {
  return 2 * pi * CounterRandom(seed, frame, key).uniform();
}

void set_frame(Sources& sources, uint32_t frame) {
  for (size_t i = 0; i < sources.phase_keys.size(); ++i) {
    const uint64_t key = sources.phase_keys[i];
    if (key == Sources::no_phase_key) continue;
    const double change = random_phase(sources.seed, frame, key) - random_phase(sources.seed, sources.frame, key);
    sources.waves[i].phase = float(sources.waves[i].phase + change);
  }
  sources.frame = frame;
}

}  // namespace holotrace
