// Calls of the system that fail, and interrupts at chosen calls, by strace: exact places where a full disk or Ctrl-C hits.

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "end_to_end/faults.h"
#include "end_to_end/scenes.h"
#include "holotrace/io/run_folder.h"

namespace holotrace::test {
namespace {

constexpr const char* renames = "?rename,?renameat,renameat2";
// Calls that need room; strace counts each by itself.
constexpr const char* writes[] = {"write", "writev", "pwrite64", "fsync", "?mkdir", "mkdirat"};

std::map<std::string, std::string> files_in(const Workplace& work) {
  std::map<std::string, std::string> files;
  for (const std::string& name : work.names())
    files[name] = std::filesystem::is_directory(work.path(name)) ? "folder" : work.read(name);
  return files;
}

class Faults : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_strace(work)) GTEST_SKIP() << "strace makes calls fail; here it is missing or may not watch programs";
    work.write("scene.toml", mesh_scene());
    ASSERT_EQ(work.run({"field", "scene.toml", "-o", "f.npy"}).exit_code, 0);
    ASSERT_EQ(work.run({"encode", "f.npy", "-o", "h.png"}).exit_code, 0);
  }

  // Each command that writes runs once, and then again with a full disk at its 1st, 2nd, 4th, 8th, … call that needs
  // room: it must say so, keep all files as they were, and leave no others.
  void expect_safe(const std::vector<std::string>& arguments) {
    const Outcome first = work.run(arguments);
    ASSERT_EQ(first.exit_code, 0) << first.err;
    auto before = files_in(work);
    int hits = 0;
    for (const char* call : writes)
      for (int at = 1; at <= 1024; at *= 2) {
        const FaultyRun run = run_with(work, {call, "error=ENOSPC", at}, arguments);
        const std::string what = arguments[0] + " " + arguments.back() + ", " + run.call + "\n" + run.outcome.err;
        // The FFT plans of the cache may be lost, the progress, and what goes to the standard output once the files are
        // written.
        const bool is_output = !run.call.empty() && run.call.find("/holotrace-cache-") == std::string::npos &&
                               run.call.find(".progress") == std::string::npos &&
                               run.call.find("(1<") == std::string::npos;
        if (!is_output) before = files_in(work);  // a run's report has its times
        if (run.call.empty()) break;
        if (!is_output) continue;
        EXPECT_TRUE(files_in(work) == before) << what;
        ++hits;
        EXPECT_EQ(run.outcome.exit_code, 1) << what;
        EXPECT_EQ(run.outcome.err.rfind("holotrace: expected to write ", 0), 0U) << what;
        EXPECT_NE(run.outcome.err.find(" room "), std::string::npos) << what;  // what to look after
        EXPECT_EQ(run.outcome.err.find(".holotrace-"), std::string::npos) << what;
      }
    EXPECT_GE(hits, 1) << arguments[0];  // the whole file may be one call
  }

  const Workplace work;
};

TEST_F(Faults, AFullDiskKeepsPicturesAndFields) {
  expect_safe({"render", "scene.toml", "-o", "r.png"});
  expect_safe({"trace", "scene.toml", "-o", "s.ply"});
  expect_safe({"field", "scene.toml", "-o", "g.npy"});
  expect_safe({"field", "scene.toml", "-o", "g.h5"});
  expect_safe({"encode", "f.npy", "-o", "k.png"});
}

TEST_F(Faults, AFullDiskKeepsViewsAndRuns) {
  expect_safe({"show", "h.png", "--distances", "29 mm, 30 mm", "-o", "v.png"});
  expect_safe({"calibrate", "patterns", "--distance", "30 mm", "--slm", "scene.toml", "-o", "patterns"});
  expect_safe({"run", "scene.toml", "-o", "out", "-q"});
}

TEST_F(Faults, AFullDiskBehindTheStandardOutputIsNoticed) {
  const FaultyRun run = run_with(work, {"write", "error=ENOSPC", 1}, {"limits", "--json"});
  EXPECT_EQ(run.outcome.exit_code, 1);
  EXPECT_NE(run.outcome.err.find("expected to write the standard output"), std::string::npos) << run.outcome.err;
}

// An interrupt before files get their names keeps all earlier ones. After that it waits until all have their names, and
// says that they are written.
TEST_F(Faults, AnInterruptFindsTheFilesOfOneRun) {
  const std::vector<std::string> command{"run", "scene.toml", "-o", "out", "-q"};
  ASSERT_EQ(work.run({"run", "scene.toml", "-o", "out", "-q", "--seed", "5"}).exit_code, 0);
  const auto whole = [&](const std::string& place) {
    const auto report = nlohmann::json::parse(work.read("out/report.json"));
    EXPECT_TRUE(report.at("complete")) << place;
    const FileRecord record = report_record(work.path("out/report.json"));
    EXPECT_EQ(record.size(), 7U);  // render and its radiance, sources, field, its .json, hologram, view
    for (const auto& [name, bytes] : record) EXPECT_EQ(std::filesystem::file_size(work.path("out/" + name)), bytes);
    return report.at("seed").get<int>();
  };
  // 8 files get the names of the folder that is made beside them, then the old report is marked as incomplete, then 8
  // files get their last names.
  for (const int at : {1, 8, 9, 10, 13, 17}) {
    const FaultyRun run = run_with(work, {renames, "signal=SIGINT", at}, command);
    const std::string place = "rename " + std::to_string(at) + ": " + run.outcome.err;
    EXPECT_EQ(run.outcome.exit_code, 130) << place;
    const bool is_written = at > 8;
    EXPECT_EQ(run.outcome.err, is_written ? "holotrace: interrupted; the files of this call are written\n"
                                          : "holotrace: interrupted; files of earlier calls are as they were\n")
        << place;
    EXPECT_EQ(whole(place) == 5, !is_written) << place;
  }
  EXPECT_EQ(run_with(work, {renames, "signal=SIGINT", 18}, command).outcome.exit_code, 0);  // there are no more
  for (const std::string& name : work.names()) EXPECT_EQ(name.find(".holotrace-"), std::string::npos) << name;
}

}  // namespace
}  // namespace holotrace::test
