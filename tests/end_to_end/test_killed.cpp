// A killed run leaves complete files or none.

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "end_to_end/scenes.h"
#include "holotrace/io/field/field_file.h"
#include "holotrace/io/field/hologram_file.h"
#include "holotrace/io/field/sources_file.h"
#include "holotrace/io/picture/image_file.h"
#include "holotrace/io/run_folder.h"
#include "support/program.h"

namespace holotrace::test {
namespace {

// A scene on a panel of 4 million pixels, so that writing takes long enough to be interrupted.
std::string large_scene() {
  std::string scene = scene_head({2048, 2048, 8e-6}) + points_object();
  return scene + "[render]\nrows = 32\npaths = 1\n[camera]\ndistances = \"0 mm\"\n";
}

// Every file with a final name must be readable and complete; and if the report says so, all of them are there.
void expect_whole_files(const Workplace& work) {
  if (work.has("out/report.json")) {
    const auto report = nlohmann::json::parse(work.read("out/report.json"));
    if (report.at("complete")) {
      for (const auto& [name, bytes] : report_record(work.path("out/report.json")))
        EXPECT_TRUE(work.has("out/" + name) && std::filesystem::file_size(work.path("out/" + name)) == bytes) << name;
    }
  }
  for (const std::string& name : work.names()) {
    const std::string file = std::filesystem::path(name).filename().string();
    // Under temporary names, and in folders with such names, files may be incomplete.
    if (!name.starts_with("out/") || name.find(".holotrace-") != std::string::npos) continue;
    const std::string path = work.path(name);
    if (file == "field.npy") {
      EXPECT_NO_THROW(load_field(path)) << name;
    }
    if (file == "hologram.png") {
      EXPECT_NO_THROW(load_hologram(path)) << name;
    }
    if (file == "render.png" || file == "view.png") {
      EXPECT_NO_THROW(load_image(path)) << name;
    }
    if (file == "sources.ply") {
      EXPECT_NO_THROW(load_sources(path, 0)) << name;
    }
    if (file == "report.json") {
      EXPECT_EQ(work.read(name).back(), '\n') << name;
    }
  }
}

void end_by_kill(pid_t child) {
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
}

TEST(Killed, ARunLeavesNoFileThatLooksWholeAndIsNot) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.1}}}));
  work.write("scene.toml", large_scene());
  const pid_t child = work.start({"run", "scene.toml", "-o", "out"});
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  end_by_kill(child);
  expect_whole_files(work);
}

TEST(Killed, DuringWritingLeavesWholeFilesAndTheNextRunIsWhole) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.1}}}));
  work.write("scene.toml", large_scene());
  // Killed as soon as the folder has that many files, with temporary or final names: at each stage of writing.
  for (const size_t count : {1U, 3U, 5U, 6U}) {
    std::filesystem::remove_all(work.path("out"));
    const pid_t child = work.start({"run", "scene.toml", "-o", "out"});
    const auto present = [&] {
      std::error_code ignored;
      size_t files = 0;
      for (std::filesystem::recursive_directory_iterator i(work.path("out"), ignored), end; i != end;
           i.increment(ignored))
        ++files;
      return files;
    };
    while (present() < count && waitpid(child, nullptr, WNOHANG) == 0)
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    end_by_kill(child);
    expect_whole_files(work);
  }
  const Outcome again = work.run({"run", "scene.toml", "-o", "out"});
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_TRUE(work.has("out/report.json"));
  expect_whole_files(work);
  for (const std::string& name : work.names())
    EXPECT_EQ(name.find(".holotrace-"), std::string::npos) << name << " was left by a killed run";
}

// Presses Ctrl-C as soon as the file is there. @return the exit code of the program, and what it said
Outcome interrupt(const Workplace& work, const std::vector<std::string>& arguments, const std::string& file) {
  const pid_t child = work.start_under({"sh", "-c", "exec \"$0\" \"$@\" 2>said.txt"}, arguments);
  int status = 0;
  bool is_running = true;
  while (!work.has(file) && is_running) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    is_running = waitpid(child, &status, WNOHANG) == 0;
  }
  if (is_running) {
    kill(child, SIGINT);
    waitpid(child, &status, 0);
  }
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, "", work.read("said.txt")};
}

TEST(Interrupted, ARunSaysWhatIsKeptAndEndsWith130) {
  const Workplace work;
  work.write("points.ply", point_file({{{0, 0, -0.1}}}));
  work.write("scene.toml", large_scene());
  const Outcome outcome = interrupt(work, {"run", "scene.toml", "-o", "out"}, "out");
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(outcome.err, "holotrace: interrupted; files of earlier calls are as they were\n");
  EXPECT_FALSE(work.has("out/report.json"));
}

TEST(Interrupted, AFieldInBandsSaysThatItsBandsAreKept) {
  const Workplace work;
  work.write("points.ply", point_file(std::vector<Luminous>(2000, {{0, 0, -0.1}})));
  work.write("scene.toml", large_scene());
  // 2000 waves on 4 million pixels one by one: about a minute, in bands of some seconds.
  const std::vector<std::string> field{"field", "scene.toml", "-o", "f.h5", "--method", "exact", "--memory", "80 MB"};
  const Outcome outcome = interrupt(work, field, "f.h5.partial.json");
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_EQ(outcome.err,
            "holotrace: interrupted; the finished bands are kept, and the same command goes on from there\n");
  EXPECT_TRUE(work.has("f.h5.partial"));
}

}  // namespace
}  // namespace holotrace::test
