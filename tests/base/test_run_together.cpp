#include <gtest/gtest.h>

#include <latch>
#include <thread>

#include "holotrace/base/error.h"
#include "holotrace/base/own_threads.h"
#include "support/error_of.h"

namespace holotrace {
namespace {

TEST(RunTogether, RunsAllCallsAtTheSameTime) {
  std::latch all(3);  // each call waits for the others
  std::vector<std::thread::id> threads(3);
  run_together(3, [&](int i, const std::atomic<bool>&) {
    threads[size_t(i)] = std::this_thread::get_id();
    all.arrive_and_wait();
  });
  EXPECT_EQ(threads[0], std::this_thread::get_id());
  EXPECT_NE(threads[1], threads[0]);
  EXPECT_NE(threads[2], threads[1]);
}

TEST(RunTogether, StopsTheOthersIfOneFails) {
  const auto run = [] {
    run_together(3, [](int i, const std::atomic<bool>& is_stopped) {
      if (i == 1) throw Error("the second");
      while (!is_stopped) std::this_thread::yield();
      if (i == 2) throw Error("the third");
    });
  };
  EXPECT_EQ(error_of(run), "the second");
}

TEST(RunTogether, DoesNothingForNoCalls) {
  run_together(0, [](int, const std::atomic<bool>&) { FAIL(); });
}

}  // namespace
}  // namespace holotrace
