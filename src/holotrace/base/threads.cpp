#include "holotrace/base/threads.h"

#include <atomic>

#include "holotrace/base/sanitizers.h"

#if HOLOTRACE_THREAD_SANITIZER
#include "holotrace/base/sanitized.h"
#else
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#endif

namespace holotrace {

void for_each_range(int64_t begin, int64_t end, int64_t grain, const Observer& observer,
                    void (*work)(const void* of, int64_t first, int64_t last), const void* of) {
  std::atomic<int64_t> done{0};
  const auto work_on = [&](int64_t first, int64_t last) {
    work(of, first, last);
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
