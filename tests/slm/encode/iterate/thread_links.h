#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "holotrace/base/error.h"
#include "holotrace/base/process_links.h"

namespace holotrace::test {

/// Threads that stand for processes: process 0 is the one that calls, the others do `work` until it is destroyed.
class ThreadLinks : public ProcessLinks {
 public:
  ThreadLinks(int count, const std::function<void(ProcessLinks& links)>& work) : count_(count) {
    for (int i = 1; i < count; ++i)
      threads_.emplace_back([this, i, work] {
        Other links(*this, i);
        try {
          for (;;) work(links);
        } catch (const std::exception& error) {
          put(i, 0, {error.what(), true});
        }
      });
  }
  ~ThreadLinks() override {
    {
      const std::lock_guard lock(mutex_);
      is_closed_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }
  ThreadLinks(const ThreadLinks&) = delete;

  int count() const override { return count_; }
  PlaceOnMachine here() const override { return {0, count_}; }
  void send(int to, const std::string& bytes) override { put(0, to, {bytes, false}); }
  std::string receive(int from) override { return take(from, 0); }

  /// Bytes that went to the others, and that came from them.
  size_t bytes_out() {
    const std::lock_guard lock(mutex_);
    return bytes_out_;
  }
  size_t bytes_in() {
    const std::lock_guard lock(mutex_);
    return bytes_in_;
  }

 private:
  struct Message {
    std::string bytes;
    bool is_failure;
  };

  // The links of another process.
  class Other : public ProcessLinks {
   public:
    Other(ThreadLinks& all, int number) : all_(all), number_(number) {}
    int count() const override { return all_.count_; }
    PlaceOnMachine here() const override { return {number_, all_.count_}; }
    void send(int to, const std::string& bytes) override { all_.put(number_, to, {bytes, false}); }
    std::string receive(int from) override { return all_.take(from, number_); }

   private:
    ThreadLinks& all_;
    int number_;
  };

  void put(int from, int to, Message message) {
    {
      const std::lock_guard lock(mutex_);
      (to == 0 ? bytes_in_ : bytes_out_) += message.bytes.size();
      boxes_[{from, to}].push_back(std::move(message));
    }
    changed_.notify_all();
  }

  std::string take(int from, int to) {
    std::unique_lock lock(mutex_);
    std::deque<Message>& box = boxes_[{from, to}];
    changed_.wait(lock, [&] { return !box.empty() || is_closed_; });
    require(!box.empty(), "closed");
    const Message message = std::move(box.front());
    box.pop_front();
    if (message.is_failure) throw Error(message.bytes);
    return message.bytes;
  }

  int count_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::pair<int, int>, std::deque<Message>> boxes_;
  bool is_closed_ = false;
  size_t bytes_in_ = 0, bytes_out_ = 0;
  std::vector<std::thread> threads_;
};

}  // namespace holotrace::test
