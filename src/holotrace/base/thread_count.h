#pragma once

namespace holotrace {

/// How many threads parallel_for works on here: all that the machine has, or the fewer that --threads allows.
int thread_count();

}  // namespace holotrace
