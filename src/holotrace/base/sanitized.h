#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "holotrace/base/machine.h"

namespace holotrace {

/// Calls work(first, last) for ranges of `grain` that make up [begin, end), on threads of their own, for builds under
/// the thread sanitizer. The sanitizer cannot follow how oneTBB, which is built without it, passes work to threads,
/// and would report every loop. What it reports here is in the loops. At least three threads run, unless only one may.
template <class Work>
void for_each_range_on_new_threads(int64_t begin, int64_t end, int64_t grain, const Work& work) {
  std::atomic<int64_t> next{begin};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto run = [&] {
    for (;;) {
      const int64_t first = next.fetch_add(grain);
      if (first >= end) return;
      try {
        work(first, std::min(first + grain, end));
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
        next = end;
      }
    }
  };
  const int64_t ranges = (end - begin + grain - 1) / grain, allowed = thread_count();
  std::vector<std::thread> threads;
  for (int64_t t = 1; t < std::min<int64_t>(ranges, allowed > 1 ? std::max<int64_t>(allowed, 3) : 1); ++t)
    threads.emplace_back(run);
  run();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace holotrace
