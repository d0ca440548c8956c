#pragma once

#include <atomic>
#include <cstdint>

#include "holotrace/base/observer.h"
#include "holotrace/base/sanitizers.h"

#if HOLOTRACE_THREAD_SANITIZER
#include "holotrace/base/sanitized.h"
#else
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#endif

namespace holotrace {

/// Calls `work(i)` once for every i in [begin, end), on oneTBB's threads.
/// A result must not depend on the order of the calls. `observer` receives the fraction done, from any
/// thread. An exception thrown by `work` stops the loop and reaches the caller.
template <class Work>
void parallel_for(int64_t begin, int64_t end, const Work& work, const Observer& observer = {}, int64_t grain = 1) {
  std::atomic<int64_t> done{0};
  const auto work_on = [&](int64_t first, int64_t last) {
    for (int64_t i = first; i != last; ++i) work(i);
    const int64_t count = done += last - first;
    observer.progress(double(count) / double(end - begin));
  };
#if HOLOTRACE_THREAD_SANITIZER
  for_each_range_on_new_threads(begin, end, grain, work_on);
#else
  tbb::parallel_for(tbb::blocked_range<int64_t>(begin, end, size_t(grain)),
                    [&](const auto& range) { work_on(range.begin(), range.end()); });
#endif
}

}  // namespace holotrace
