#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <queue>
#include <thread>

namespace holotrace {

/// A thread that calls functions one after the other, in the order in which they come. Libraries keep memory for each
/// thread that ever used them, so that what many short-lived threads ask for is computed in one that lasts.
class LastingThread {
 public:
  LastingThread();
  ~LastingThread();  ///< after the calls that wait
  LastingThread(const LastingThread&) = delete;
  LastingThread& operator=(const LastingThread&) = delete;

  /// Calls `work` in this thread and waits for its end. @throws what `work` throws
  void call(const std::function<void()>& work);

 private:
  std::mutex mutex_;
  std::condition_variable is_new_;
  std::queue<std::function<void()>> waiting_;
  bool is_ending_ = false;
  std::thread thread_;  // last: it uses what is above
};

}  // namespace holotrace
