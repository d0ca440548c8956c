#pragma once

#include <cstdint>

#include "holotrace/base/observer.h"

namespace holotrace {

/// Calls work(first, last) for ranges of at least `grain` that make up [begin, end), each once, on oneTBB's threads. `observer`
/// receives the fraction done, from any thread. An exception thrown by `work` stops the loop and reaches the caller. Loops are
/// written with `parallel_for`; this function keeps what is the same in all of them compiled once.
void for_each_range(int64_t begin, int64_t end, int64_t grain, const Observer& observer,
                    void (*work)(const void* of, int64_t first, int64_t last), const void* of);

/// Calls `work(i)` once for every i in [begin, end), on oneTBB's threads.
/// A result must not depend on the order of the calls. `observer` receives the fraction done, from any
/// thread. An exception thrown by `work` stops the loop and reaches the caller.
template <class Work>
void parallel_for(int64_t begin, int64_t end, const Work& work, const Observer& observer = nobody(),
                  int64_t grain = 1) {
  const auto range = [](const void* of, int64_t first, int64_t last) {
    const Work& each = *static_cast<const Work*>(of);
    for (int64_t i = first; i != last; ++i) each(i);
  };
  for_each_range(begin, end, grain, observer, range, &work);
}

}  // namespace holotrace
