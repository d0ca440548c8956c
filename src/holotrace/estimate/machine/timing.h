#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <vector>

#include "holotrace/base/machine.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Seconds that `work` takes: the median of several runs.
template <class Work>
double median_seconds(int runs, const Work& work) {
  std::vector<double> seconds;
  for (int i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::nth_element(seconds.begin(), seconds.begin() + runs / 2, seconds.end());
  return seconds[size_t(runs) / 2];
}

/// Seconds that one call of `work` takes.
template <class Work>
double seconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Calls of `work` per second, on all threads at once: the best of several rounds of about 10 ms, since other work on
/// the machine can only slow a round down. One call should take 10 µs to 1 ms.
template <class Work>
double peak_call_rate(const Work& work, int rounds = 5) {
  constexpr double round_seconds = 10e-3;
  work();  // start threads and make buffers that the first call needs
  const double one = std::max(seconds_of(work), 1e-9);
  const int64_t calls = std::max<int64_t>(1, std::llround(round_seconds / one)) * thread_count();
  double best = 0;
  for (int round = 0; round < rounds; ++round)
    best = std::max(best, double(calls) / seconds_of([&] { parallel_for(0, calls, [&](int64_t) { work(); }); }));
  return best;
}

// Jobs for measurements of speed: used by holotrace bench, by bench/, and by the calibration of the cost model. The
// wavelength is 532 nm, and the seed is fixed.

inline constexpr double timed_wavelength = 532e-9;
inline constexpr Grid timed_full_hd{1920, 1080, 8e-6};
inline constexpr Grid timed_ultra_hd{3840, 2160, 3.74e-6};

/// Waves of random phase, spread evenly over the panel and over depths from `nearest` to `farthest` [m].
Sources timed_waves(const Grid& panel, int64_t count, double nearest, double farthest);

/// The half of a sphere of 8 mm that faces the panel, 0.2 m behind it, as about `count` triangles of random phase;
/// triangles that face the panel more directly are brighter.
Triangles timed_half_sphere(int64_t count);

/// A field of amplitude 1 and random phases.
Field timed_field(const Grid& panel);

}  // namespace holotrace
