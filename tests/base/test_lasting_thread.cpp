#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

#include "holotrace/base/own_threads.h"

namespace holotrace {
namespace {

TEST(LastingThread, IsTheSameForAllCallersAndDoesOneThingAtATime) {
  std::vector<std::thread::id> ids(20);  // written by one thread, without a lock
  std::atomic<int> running = 0, most = 0;
  LastingThread thread;
  std::vector<std::thread> callers;
  for (size_t i = 0; i < ids.size(); ++i)
    callers.emplace_back([&, i] {
      thread.call([&] {
        most = std::max(most.load(), ++running);
        ids[i] = std::this_thread::get_id();
        --running;
      });
    });
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(most, 1);
  for (const std::thread::id& id : ids) EXPECT_EQ(id, ids.front());
  EXPECT_NE(ids.front(), std::this_thread::get_id());
}

TEST(LastingThread, GivesErrorsToTheCallerAndGoesOn) {
  LastingThread thread;
  EXPECT_THROW(thread.call([] { throw std::runtime_error("no"); }), std::runtime_error);
  int answer = 0;
  thread.call([&] { answer = 42; });
  EXPECT_EQ(answer, 42);
}

}  // namespace
}  // namespace holotrace
