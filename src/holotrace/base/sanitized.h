#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <new>
#include <thread>
#include <vector>

#include "holotrace/base/machine.h"

namespace holotrace {

/// Cache-aligned memory from the system's allocator, for builds under the sanitizers. The sanitizers do not see the
/// blocks of oneTBB's own allocator: writes past the end of a buffer, or data races in it, would go unnoticed.
template <class T>
struct SanitizedAllocator {
  using value_type = T;

  SanitizedAllocator() = default;
  template <class U>
  SanitizedAllocator(const SanitizedAllocator<U>&) {}

  T* allocate(size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), alignment)); }
  void deallocate(T* data, size_t) { ::operator delete(data, alignment); }

  template <class U>
  bool operator==(const SanitizedAllocator<U>&) const {
    return true;
  }

 private:
  static constexpr std::align_val_t alignment{128};  // the alignment of oneTBB's allocator
};

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
