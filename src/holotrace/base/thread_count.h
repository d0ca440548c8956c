#pragma once

namespace holotrace {

/// Number of threads that parallel_for uses: all that the machine has, or fewer if --threads says so.
int thread_count();

}  // namespace holotrace
