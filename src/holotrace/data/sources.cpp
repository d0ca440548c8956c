#include "holotrace/data/sources.h"

#include <algorithm>

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

bool has_waves_in_front(const Sources& sources) {
  return std::any_of(sources.waves.begin(), sources.waves.end(), [](const Source& s) { return s.origin.z > 0; });
}

SourceSides sides_of(const Sources& sources) {
  const size_t count = sources.waves.size();
  const size_t tiles = size_t(sources.tiles.columns) * size_t(sources.tiles.rows);
  SourceSides sides;
  for (Sources* side : {&sides.behind, &sides.mirrored}) {
    const bool is_mirrored = side == &sides.mirrored;
    *side = {sources.wavelength,
             {},
             {sources.tiles.columns, sources.tiles.rows, {}},
             sources.name,
             {},
             sources.seed,
             sources.frame,
             sources.cone_wavelength};
    const auto belongs = [&](size_t i) { return (sources.waves[i].origin.z > 0) == is_mirrored; };
    for (size_t i = 0; i < count; ++i) {
      if (!belongs(i)) continue;
      const Source& wave = sources.waves[i];
      const Vec3 mirror{wave.origin.x, wave.origin.y, -wave.origin.z};
      side->waves.push_back(is_mirrored ? Source{mirror, wave.amplitude, -wave.phase} : wave);
    }
    for (size_t tile = 0; tile < tiles; ++tile)
      for (size_t i = 0; i < count; ++i)
        if (belongs(i)) side->tiles.values.push_back(sources.tiles.values[tile * count + i]);
  }
  return sides;
}

}  // namespace holotrace
