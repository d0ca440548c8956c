#include "holotrace/base/own_threads.h"

#include <exception>
#include <future>
#include <thread>
#include <utility>
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

LastingThread::LastingThread()
    : thread_([this] {
        std::unique_lock lock(mutex_);
        for (;;) {
          is_new_.wait(lock, [&] { return is_ending_ || !waiting_.empty(); });
          if (waiting_.empty()) return;
          const std::function<void()> work = std::move(waiting_.front());
          waiting_.pop();
          lock.unlock();
          work();
          lock.lock();
        }
      }) {}

LastingThread::~LastingThread() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  is_new_.notify_one();
  thread_.join();
}

void LastingThread::call(const std::function<void()>& work) {
  std::packaged_task<void()> task(work);
  std::future<void> end = task.get_future();
  {
    const std::lock_guard lock(mutex_);
    waiting_.emplace([&task] { task(); });
  }
  is_new_.notify_one();
  end.get();
}

}  // namespace holotrace
