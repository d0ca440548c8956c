#pragma once

#include <benchmark/benchmark.h>

#include <string>

#include "holotrace/base/units.h"
#include "holotrace/estimate/machine/timing.h"

// The jobs of the benchmarks, and functions for their counters. Ceilings are those of holotrace bench
// (docs/explanation/performance.md).

namespace holotrace {

using namespace literals;

/// The panel of the argument "panel": 0: 1920×1080 at 8 µm, 1: 3840×2160 at 3.74 µm.
inline Grid panel_of(int64_t index) { return index == 0 ? timed_full_hd : timed_ultra_hd; }

/// The waves of the argument "depths": 0: 0.19–0.21 m, 1: 0.15–0.25 m.
inline Sources waves_of(const Grid& panel, int64_t count, int64_t depths) {
  return depths == 0 ? timed_waves(panel, count, 0.19_m, 0.21_m) : timed_waves(panel, count, 0.15_m, 0.25_m);
}

/// Sets the counters "UNIT/s" and, if the ceiling is known, "of_ceiling"; each iteration does `amount` units.
inline void count(benchmark::State& state, const std::string& unit, double amount, double ceiling = 0) {
  using benchmark::Counter;
  state.counters[unit + "/s"] = Counter(amount, Counter::kIsIterationInvariantRate);
  if (ceiling > 0) state.counters["of_ceiling"] = Counter(amount / ceiling, Counter::kIsIterationInvariantRate);
}

}  // namespace holotrace
