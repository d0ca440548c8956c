#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>

#include "holotrace/base/thread_count.h"
#include "holotrace/base/threads.h"

namespace holotrace {

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

}  // namespace holotrace
