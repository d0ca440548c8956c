#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <queue>
#include <thread>

namespace holotrace {

/// Calls work(i, is_stopped) for i = 0 … count − 1 at the same time, whatever the number of threads of other loops: the first
/// call on this thread, each other one on a thread of its own. Waits for all. If one throws, `is_stopped` becomes true, which
/// the others should look at, and its error is thrown here; of several, that of the least i.
void run_together(int count, const std::function<void(int i, const std::atomic<bool>& is_stopped)>& work);

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
