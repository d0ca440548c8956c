#pragma once

#include <benchmark/benchmark.h>

#include <string>

#include "holotrace/base/random.h"
#include "holotrace/base/units.h"
#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"

// The jobs of the benchmarks, and how their counters are made. Ceilings are those of holotrace bench
// (docs/performance.md).

namespace holotrace {

using namespace literals;

/// By the argument "panel": 0: 1920×1080 at 8 µm, 1: 3840×2160 at 3.74 µm.
inline Grid panel_of(int64_t index) { return index == 0 ? Grid{1920, 1080, 8_um} : Grid{3840, 2160, 3.74_um}; }

/// By the argument "depths": 0: 0.19–0.21 m, 1: 0.15–0.25 m. Waves of random place over the panel and random phase.
inline Sources random_sources(const Grid& panel, int64_t count, int64_t depths) {
  const double nearest = depths == 0 ? 0.19_m : 0.15_m, farthest = depths == 0 ? 0.21_m : 0.25_m;
  Sources sources;
  sources.wavelength = 532_nm;
  CounterRandom random(1, 0, 0);
  for (int64_t j = 0; j < count; ++j)
    sources.waves.push_back({{(random.uniform() - 0.5) * panel.width(), (random.uniform() - 0.5) * panel.height(),
                              -nearest - (farthest - nearest) * random.uniform()},
                             1,
                             float(2 * pi * random.uniform())});
  return sources;
}

inline Field random_phases(const Grid& panel) {
  Field field(panel, 532_nm);
  CounterRandom random(1, 0, 0);
  for (auto& u : field.samples.values) u = std::polar(1.0F, float(2 * pi * random.uniform()));
  return field;
}

/// Counters "UNIT/s" and, where the ceiling is known, "of_ceiling": `amount` units are done in each iteration.
inline void count(benchmark::State& state, const std::string& unit, double amount, double ceiling = 0) {
  using benchmark::Counter;
  state.counters[unit + "/s"] = Counter(amount, Counter::kIsIterationInvariantRate);
  if (ceiling > 0) state.counters["of_ceiling"] = Counter(amount / ceiling, Counter::kIsIterationInvariantRate);
}

}  // namespace holotrace
