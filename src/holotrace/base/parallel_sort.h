#pragma once

#ifdef __SANITIZE_THREAD__
#include <algorithm>
#else
#include <tbb/parallel_sort.h>
#endif

namespace holotrace {

/// Sorts in ascending order, on all threads; under the thread sanitizer on one thread. The sanitizer cannot follow how
/// oneTBB's library passes parts of the sort to threads, and would report a data race.
template <class Iterator>
void parallel_sort(Iterator first, Iterator last) {
#ifdef __SANITIZE_THREAD__
  std::sort(first, last);
#else
  tbb::parallel_sort(first, last);
#endif
}

}  // namespace holotrace
