#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "holotrace/io/files/progress_file.h"
#include "support/temporary.h"

namespace holotrace::test {
namespace {

std::string new_folder(const std::string& name) {
  const std::string folder = temporary(name);
  std::filesystem::create_directories(folder);
  return folder;
}

nlohmann::json progress_in(const std::string& folder) {
  return nlohmann::json::parse(running_progress(folder).value_or("null"));
}

TEST(ProgressFile, IsThereWhileItsJobRuns) {
  const std::string folder = new_folder("out");
  EXPECT_FALSE(running_progress(folder));
  {
    ProgressFile file(folder);
    file.begin_stage("encode");
    EXPECT_EQ(progress_in(folder)["stage"], "encode");
    file.tell("loss -3 dB");
    std::this_thread::sleep_for(std::chrono::milliseconds(600));  // it is written twice a second
    file.update(0.25);
    const nlohmann::json json = progress_in(folder);
    EXPECT_EQ(json["fraction"], 0.25);
    EXPECT_EQ(json["status"], "loss -3 dB");
    EXPECT_EQ(json["history"], (nlohmann::json{{0.0, "loss -3 dB"}}));
    file.begin_stage("b");  // a shorter text leaves nothing of the longer one
    EXPECT_EQ(progress_in(folder)["stage"], "b");
    EXPECT_TRUE(progress_in(folder)["history"].empty());
  }
  EXPECT_FALSE(running_progress(folder));
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(ProgressFile, KeepsABoundedHistoryOfTheWholeStage) {
  const std::string folder = new_folder("out");
  ProgressFile file(folder);
  file.begin_stage("encode");
  constexpr int calls = 10000;
  for (int i = 0; i < calls; ++i) {
    file.update(double(i) / calls);
    file.tell("loss");
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  file.update(1);
  const nlohmann::json history = progress_in(folder)["history"];
  EXPECT_LT(history.size(), ProgressFile::most_entries);
  EXPECT_GE(history.size(), ProgressFile::most_entries / 2);
  // The last place is at most two steps of the history before the end, and the steps are even.
  const double step = history[1][0].get<double>() - history[0][0].get<double>();
  EXPECT_GT(history.back()[0].get<double>(), 1 - 2 * step);
  for (size_t i = 1; i < history.size(); ++i)
    EXPECT_NEAR(history[i][0].get<double>() - history[i - 1][0].get<double>(), step, 1e-12);
}

TEST(ProgressFile, OfAKilledProgramIsNoProgress) {
  const std::string folder = new_folder("out");
  std::ofstream(folder + "/" + temporary_name(".progress")) << R"({"stage": "encode"})";  // nobody has locked it
  EXPECT_FALSE(running_progress(folder));
  remove_abandoned(folder);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(ProgressFile, DoesWithoutAFolder) {
  ProgressFile file("/nonexistent/folder");
  file.begin_stage("encode");
  file.update(0.5);
  file.tell("loss");
  EXPECT_FALSE(running_progress("/nonexistent/folder"));
}

}  // namespace
}  // namespace holotrace::test
