#include "holotrace/base/run_together.h"

#include <exception>
#include <thread>
#include <vector>

namespace holotrace {

void run_together(int count, const std::function<void(int i, const std::atomic<bool>& is_stopped)>& work) {
  std::atomic<bool> is_stopped = false;
  std::vector<std::exception_ptr> errors(static_cast<size_t>(count));
  const auto run = [&](int i) {
    try {
      work(i, is_stopped);
    } catch (...) {
      errors[size_t(i)] = std::current_exception();
      is_stopped = true;
    }
  };
  {
    std::vector<std::jthread> others;  // joined at the end of this block
    for (int i = 1; i < count; ++i) others.emplace_back(run, i);
    if (count > 0) run(0);
  }
  for (const std::exception_ptr& error : errors)
    if (error) std::rethrow_exception(error);
}

}  // namespace holotrace
