// Many processes: the ranks of mpirun share the frames of `encode --method sgd`.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <nlohmann/json.hpp>

#include "end_to_end/mpirun.h"
#include "end_to_end/scenes.h"
#include "support/build_paths.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

using Json = nlohmann::json;

class FrameRanks : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!HOLOTRACE_HAS_MPI) GTEST_SKIP() << "this build is without MPI";
    if (!has_mpirun()) GTEST_SKIP() << "there is no mpirun to start ranks with";
    work.write("points.ply", point_file({{{0.0001, 0, -0.04}, {-0.0002, 0.0001, -0.042}}}));
    work.write("scene.toml", scene_head() + points_object() + "[render]\npaths = 1\n");
    ASSERT_EQ(work.run({"render", "scene.toml", "-o", "stack.h5", "--focal-stack", "40 mm, 42 mm"}).exit_code, 0);
  }

  static std::vector<std::string> job(int frames, const std::string& name, const std::string& device = "cpu",
                                      const std::string& wavelengths = "632.8 nm") {
    return {"encode",       "stack.h5",    "--slm",    "scene.toml",
            "--wavelength", wavelengths,   "--frames", std::to_string(frames),
            "--iterations", "4",           "--method", "sgd",
            "--device",     device,        "-o",       name + ".png",
            "--report",     name + ".json"};
  }

  // Runs a job; its stages.
  Json stages(int ranks, int frames, const std::string& name, const std::string& device = "cpu",
              const std::string& wavelengths = "632.8 nm") {
    const std::vector<std::string> arguments = job(frames, name, device, wavelengths);
    const Outcome outcome = ranks == 0 ? work.run(arguments) : work.run_under(mpirun(ranks), arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.exit_code == 0 ? Json::parse(work.read(name + ".json")).at("stages") : Json::array();
  }

  bool are_equal(const std::string& a, const std::string& b, int files) const {
    for (int i = 0; i < files; ++i) {
      const std::string ending = (i == 0 ? "" : "_" + std::to_string(i + 1)) + ".png";
      if (work.read(a + ending) != work.read(b + ending)) return false;
    }
    return true;
  }

  bool has_device() const {
    return Json::parse(work.run({"info", "--devices", "--json"}).out).at("devices").size() > 1;
  }

  Workplace work;
};

size_t occurrences(const std::string& text, const std::string& part) {
  size_t found = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

// The mean of the frames is added up in another order: the loss differs by less than 0.1 dB (2 %).
void expect_same_loss(const Json& found, const Json& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < found.size(); ++i)
    for (const char* fact : {"loss_first", "loss_last"}) {
      const double loss = expected[i].at(fact);
      EXPECT_NEAR(found[i].at(fact).get<double>(), loss, 0.02 * loss) << i << fact;
    }
}

TEST_F(FrameRanks, TwoAndThreeReachTheLossOfOneProcess) {
  const Json alone = stages(0, 5, "alone", "cpu", "632.8 nm, 520 nm");
  for (const int ranks : {2, 3}) {
    const Json shared = stages(ranks, 5, "shared", "cpu", "632.8 nm, 520 nm");
    expect_same_loss(shared, alone);
    for (const Json& stage : shared) EXPECT_EQ(stage.at("processes"), ranks);
    stages(ranks, 5, "again", "cpu", "632.8 nm, 520 nm");
    EXPECT_TRUE(are_equal("again", "shared", 10)) << ranks << " ranks, twice";
  }
}

TEST_F(FrameRanks, OnDevicesReachTheLossOfOneProcess) {
  if (!has_device()) GTEST_SKIP() << "no OpenCL device here";
  const Json alone = stages(0, 3, "alone");
  for (const char* device : {"opencl", "opencl:all"}) {
    const Json shared = stages(2, 3, "shared", device);
    expect_same_loss(shared, alone);
    for (const Json& stage : shared) EXPECT_TRUE(stage.contains("device")) << stage;
  }
  stages(2, 3, "again", "opencl:all");
  EXPECT_TRUE(are_equal("again", "shared", 3));
}

TEST_F(FrameRanks, MayBeMoreThanTheFrames) {
  stages(2, 2, "two");
  EXPECT_EQ(stages(3, 2, "three").at(0).at("processes"), 2);
  EXPECT_TRUE(are_equal("two", "three", 2));
  stages(0, 1, "alone");
  EXPECT_FALSE(stages(3, 1, "single").at(0).contains("processes"));
  EXPECT_TRUE(are_equal("alone", "single", 1));
}

TEST_F(FrameRanks, ShareTheFramesOfARun) {
  const auto encoding = [&](const std::vector<std::string>& launcher, const std::string& folder) {
    const std::vector<std::string> arguments{
        "run",          "scene.toml",       "-o",       folder, "--method",     "sgd", "--target",   "render",
        "--wavelength", "632.8 nm, 520 nm", "--frames", "3",    "--iterations", "4",   "--distance", "41 mm"};
    const Outcome outcome = launcher.empty() ? work.run(arguments) : work.run_under(launcher, arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    Json found = Json::array();
    const Json report = Json::parse(work.read(folder + "/report.json"));
    for (const Json& stage : report.at("stages"))
      if (stage.at("stage").get<std::string>().starts_with("encode")) found.push_back(stage);
    return found;
  };
  const Json alone = encoding({}, "alone"), shared = encoding(mpirun(2), "shared");
  expect_same_loss(shared, alone);
  ASSERT_EQ(shared.size(), 2u);
  for (const Json& stage : shared) EXPECT_EQ(stage.at("processes"), 2);
}

// Rank 1 has no driver: it ends all ranks, with one sentence and without a file.
TEST_F(FrameRanks, OneThatFailsEndsAllWithItsSentence) {
  if (!has_device()) GTEST_SKIP() << "no OpenCL device here";
  std::vector<std::string> launcher = mpirun(1);
  const std::string program = HOLOTRACE_PROGRAM;
  std::vector<std::string> arguments = job(4, "h", "opencl");
  for (const char* part : {":", "-n", "1", "env", "OCL_ICD_VENDORS=/nonexistent"}) arguments.push_back(part);
  arguments.push_back(program);
  for (const std::string& argument : job(4, "h", "opencl")) arguments.push_back(argument);
  const Outcome outcome = work.run_under(launcher, arguments);
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_EQ(occurrences(outcome.err, "holotrace: rank 1: expected"), 1u) << outcome.err;
  EXPECT_NE(outcome.err.find("OpenCL"), std::string::npos) << outcome.err;
  EXPECT_FALSE(work.has("h.png"));
}

TEST_F(FrameRanks, GoOnFromACheckpointIfOneIsInterruptedOrKilled) {
  std::vector<std::string> whole = job(3, "whole"), again = job(3, "again");
  whole[9] = again[9] = "40";
  ASSERT_EQ(work.run_under(mpirun(2), whole).exit_code, 0);
  // Rank 0 saves what is done, also if a launcher interrupts all ranks; the state of a rank that is killed is the last that was
  // saved. The file appears when the descent begins, so ranks are in an update.
  struct Case {
    std::vector<int> ranks;
    int signal;
    const char* state;
  };
  for (const auto& [ranks, signal, state] :
       {Case{{0}, SIGINT, "a.h5"}, Case{{1, 0}, SIGINT, "b.h5"}, Case{{1}, SIGKILL, "c.h5"}}) {
    SCOPED_TRACE(state);
    std::vector<std::string> arguments = again;
    arguments.insert(arguments.end(), {"--checkpoint", state});
    const pid_t launcher = work.start_under(mpirun(2), arguments);
    int status = 0;
    while (!work.has(state) && waitpid(launcher, &status, WNOHANG) == 0) usleep(200);
    for (const int rank : ranks) {
      const pid_t process = process_of_rank(launcher, rank);
      ASSERT_GT(process, 0) << "over too soon";
      kill(process, signal);
    }
    waitpid(launcher, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) != 0);
    EXPECT_FALSE(work.has("again.png"));
    EXPECT_TRUE(work.has(state));
    const Outcome outcome = work.run_under(mpirun(2), arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_TRUE(are_equal("again", "whole", 3));
    EXPECT_FALSE(work.has(state));
    std::filesystem::remove(work.path("again.png"));
  }
}

}  // namespace
}  // namespace holotrace::test
