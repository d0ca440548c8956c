#include "holotrace/base/lasting_thread.h"

#include <future>
#include <utility>

namespace holotrace {

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
