#pragma once

#include <atomic>
#include <functional>

namespace holotrace {

/// Calls work(i, is_stopped) for i = 0 … count − 1 at the same time, whatever the number of threads of other loops: the first
/// call on this thread, each other one on a thread of its own. Waits for all. If one throws, `is_stopped` becomes true, which
/// the others should look at, and its error is thrown here; of several, that of the least i.
void run_together(int count, const std::function<void(int i, const std::atomic<bool>& is_stopped)>& work);

}  // namespace holotrace
