#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <cstdint>

#include "holotrace/base/observer.h"

namespace holotrace {

/// Calls `work(i)` for every i in [begin, end), each once, on the threads that oneTBB has.
/// A result must not depend on the order. `observer` hears the fraction done, from any
/// thread. An exception thrown by `work` stops the loop and reaches the caller.
template <class Work>
void parallel_for(int64_t begin, int64_t end, const Work& work, const Observer& observer = {}, int64_t grain = 1) {
  std::atomic<int64_t> done{0};
  tbb::parallel_for(tbb::blocked_range<int64_t>(begin, end, size_t(grain)), [&](const auto& range) {
    for (int64_t i = range.begin(); i != range.end(); ++i) work(i);
    const int64_t count = done += int64_t(range.size());
    observer.progress(double(count) / double(end - begin));
  });
}

}  // namespace holotrace
