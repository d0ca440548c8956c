#include "holotrace/base/thread_count.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace holotrace {

int thread_count() {
  const size_t allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::max(1, std::min(int(allowed), tbb::this_task_arena::max_concurrency()));
}

}  // namespace holotrace
