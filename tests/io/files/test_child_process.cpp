#include <gtest/gtest.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "holotrace/base/sanitizers.h"
#include "holotrace/io/files/child_process.h"
#include "support/temporary.h"

namespace holotrace {
namespace {

// The sentence of the Error of a child that does this.
std::string error_in_child(const std::function<void(ToParent&)>& read) {
  return error_of([&] { read_in_child("f.h5", read, [](FromChild& from) { from.value<int>(); }); });
}

TEST(ChildProcess, SendsWhatItReads) {
  std::string text;
  std::vector<double> list;
  std::vector<char> bytes(5 << 20);  // more than a pipe holds
  read_in_child(
      "f.h5",
      [](ToParent& out) {
        out.text("a text");
        out.list(std::vector<double>{1, 2, 3});
        const std::vector<char> block(5 << 20, 'x');
        out.bytes(block.data(), block.size());
      },
      [&](FromChild& from) {
        text = from.text();
        list = from.list<double>();
        from.bytes(bytes.data(), bytes.size());
      });
  EXPECT_EQ(text, "a text");
  EXPECT_EQ(list, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(bytes, std::vector<char>(5 << 20, 'x'));
}

TEST(ChildProcess, ItsErrorIsThrownHere) {
  EXPECT_EQ(error_in_child([](ToParent&) { throw Error("f.h5: expected this, got that"); }),
            "f.h5: expected this, got that");
}

TEST(ChildProcess, ACrashIsAnErrorThatNamesTheFile) {
  const std::string error = error_in_child([](ToParent&) { std::raise(SIGSEGV); });
  EXPECT_EQ(error,
            "f.h5: expected a file that can be read, but the library that reads it crashed (signal 11); the file is "
            "damaged, write it again");
}

TEST(ChildProcess, ItHasALimitOfTime) {
  const std::string error = error_in_child([](ToParent& out) {
    out.allow(0, 1 << 20);  // and the second that is always there
    for (volatile int i = 0;;) i = i + 1;
  });
  EXPECT_NE(error.find("f.h5: expected a file that can be read, but the library that reads it reached its limit"),
            std::string::npos)
      << error;
}

TEST(ChildProcess, ItHasALimitOfMemory) {
#if HOLOTRACE_ADDRESS_SANITIZER || HOLOTRACE_THREAD_SANITIZER
  GTEST_SKIP() << "sanitizers reserve terabytes of addresses";
#endif
  const std::string error = error_in_child([](ToParent&) {
    std::vector<std::vector<char>> blocks;
    for (int i = 0; i < 100; ++i) blocks.emplace_back(64 << 20);  // 6.25 GiB, and 1 is allowed
  });
  EXPECT_NE(error.find("f.h5: expected a file that can be read"), std::string::npos) << error;
}

TEST(ChildProcess, AnErrorHereEndsIt) {
  EXPECT_EQ(error_of([] {
              read_in_child(
                  "f.h5",
                  [](ToParent& out) {
                    for (;;) out.value(1);
                  },
                  [](FromChild& from) {
                    from.value<int>();
                    throw Error("enough");
                  });
            }),
            "enough");
}

TEST(ChildProcess, ItWorksWhileOtherThreadsAllocateMemory) {
  std::atomic<bool> is_done = false;
  std::thread other([&] {
    while (!is_done) std::vector<char>(100000).data()[0] = 1;
  });
  for (int i = 0; i < 50; ++i) {
    int value = 0;
    read_in_child(
        "f.h5",
        [&](ToParent& out) {
          const std::vector<int> list(1000, i);
          out.value(list.back());
        },
        [&](FromChild& from) { value = from.value<int>(); });
    EXPECT_EQ(value, i);
  }
  is_done = true;
  other.join();
}

TEST(RunProgram, PassesMoreThanAPipeHoldsBothWays) {
  std::string text;
  for (int i = 0; i < 500000; ++i) text += std::to_string(i);  // 2.9 MB, where a pipe here holds 1 MiB
  std::string_view left = text;
  const ProgramRun run = run_program({"sh", "-c", "cat; echo end >&2"}, [&] {
    const std::string_view part = left.substr(0, 70000);
    left.remove_prefix(part.size());
    return part;
  });
  EXPECT_TRUE(run.output == text);
  EXPECT_EQ(run.messages, "end\n");
  EXPECT_TRUE(run.has_succeeded && run.start_error.empty());
}

TEST(RunProgram, OneThatReadsNothingEndsNeitherThisOneNorWaits) {
  const std::string text(1 << 22, 'x');
  int asked = 0;
  const ProgramRun run = run_program({"sh", "-c", "exit 3"}, [&] { return ++asked < 100 ? text : std::string_view(); });
  EXPECT_FALSE(run.has_succeeded);
  EXPECT_LT(asked, 100);
}

TEST(RunProgram, AMissingOneIsNamedByTheSystemsReason) {
  const ProgramRun run = run_program({"holotrace-no-such-program"}, [] { return std::string_view(); });
  EXPECT_EQ(run.start_error, "No such file or directory");
  EXPECT_FALSE(run.has_succeeded);
}

}  // namespace
}  // namespace holotrace
