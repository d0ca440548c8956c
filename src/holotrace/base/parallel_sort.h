#pragma once

#ifdef __SANITIZE_THREAD__
#include <algorithm>
#else
#include <tbb/parallel_sort.h>
#endif

namespace holotrace {

/// Sorts in ascending order, on all threads. Under the thread sanitizer on one: it does not see how oneTBB's library
/// hands parts of the sort to threads, and would call it a race.
template <class Iterator>
void parallel_sort(Iterator first, Iterator last) {
#ifdef __SANITIZE_THREAD__
  std::sort(first, last);
#else
  tbb::parallel_sort(first, last);
#endif
}

}  // namespace holotrace
