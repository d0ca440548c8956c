// A job that Ctrl-C stops goes on from its checkpoint, to the same bytes.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <thread>

#include "end_to_end/scenes.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// Presses Ctrl-C as soon as the file is there. Returns the exit status of the program.
int exit_code_when_interrupted(const Workplace& work, const std::vector<std::string>& arguments,
                               const std::string& file) {
  const pid_t child = work.start(arguments);
  int status = 0;
  while (!work.has(file) && waitpid(child, &status, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  kill(child, SIGINT);
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Checkpoints, AnInterruptedJobEndsWithTheSameBytes) {
  const Workplace work;
  work.write("points.ply", point_file({{{0.0001, 0, -0.04}, {-0.0002, 0.0001, -0.042}}}));
  work.write("scene.toml", scene_head() + points_object() + "[render]\npaths = 1\n");
  ASSERT_EQ(work.run({"render", "scene.toml", "-o", "stack.h5", "--focal-stack", "40 mm, 42 mm"}).exit_code, 0);
  std::vector<std::string> job{
      "encode", "stack.h5", "--slm", "scene.toml", "--wavelength", "632.8 nm, 520 nm", "--frames",  "2", "--iterations",
      "40",     "--method", "sgd",   "-o",         "whole.png",    "--report",         "whole.json"};
  ASSERT_EQ(work.run(job).exit_code, 0);
  job[13] = "again.png";
  job.insert(job.end(), {"--checkpoint", "state.h5"});
  EXPECT_EQ(exit_code_when_interrupted(work, job, "state.h5"), 130);  // in the first colour
  EXPECT_FALSE(work.has("again.png"));
  EXPECT_EQ(exit_code_when_interrupted(work, job, "state_2.h5"), 130);  // in the second one
  EXPECT_FALSE(work.has("again.png"));

  std::vector<std::string> other = job;
  other[9] = "41";
  const Outcome refused = work.run(other);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_NE(refused.err.find("expected the checkpoint of this job in state.h5 (2 frame(s) of 256 × 192 pixels and 256 "
                             "levels at 632.8 nm, 2 target plane(s), 41 iterations), got that of another one"),
            std::string::npos)
      << refused.err;

  const Outcome outcome = work.run(job);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const char* number : {"", "_2", "_3", "_4"})
    EXPECT_EQ(work.read(std::string("again") + number + ".png"), work.read(std::string("whole") + number + ".png"))
        << number;
  EXPECT_FALSE(work.has("state.h5"));
  EXPECT_FALSE(work.has("state_2.h5"));
}

TEST(Checkpoints, AreRefusedWhereNothingIsKept) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.04}}}));
  work.write("scene.toml", scene_head() + points_object() + "[render]\npaths = 1\n");
  Outcome outcome = work.run({"run", "scene.toml", "-o", "out", "--checkpoint", "state.h5"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("expected --checkpoint only with the method sgd and the target render or light-field"),
            std::string::npos)
      << outcome.err;
  ASSERT_EQ(work.run({"render", "scene.toml", "-o", "stack.h5", "--focal-stack", "40 mm"}).exit_code, 0);
  outcome = work.run({"encode", "stack.h5", "--method", "phase", "--wavelength", "632.8 nm", "-o", "h.png",
                      "--checkpoint", "state.h5"});
  EXPECT_NE(outcome.err.find("expected --checkpoint only with --method sgd"), std::string::npos) << outcome.err;
  outcome = work.run({"encode", "stack.h5", "--method", "sgd", "-o", "h.png", "--checkpoint", "state.npy"});
  EXPECT_NE(outcome.err.find(".h5"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace holotrace::test
