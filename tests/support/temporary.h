#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "holotrace/base/error.h"
#include "support/error_of.h"

namespace holotrace::test {

/// The folder for this run's files, removed when the run ends.
class TemporaryFolder {
 public:
  TemporaryFolder() : path_(std::filesystem::path(::testing::TempDir()) / ("holotrace_" + std::to_string(getpid()))) {}
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// A path for a test's own file. A file left there earlier in the run is removed, with its sidecars.
inline std::string temporary(const std::string& name) {
  static const TemporaryFolder run;
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  const auto folder = run.path() / info->test_suite_name() / info->name();
  std::filesystem::create_directories(folder);
  const auto path = folder / name;
  std::filesystem::remove_all(path);
  std::filesystem::remove_all(std::filesystem::path(path).replace_extension(".json"));
  std::filesystem::remove_all(path.string() + ".json");
  return path.string();
}

/// Writes an input of a test.
inline std::string make_file(const std::string& name, const std::string& bytes) {
  const std::string path = temporary(name);
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

}  // namespace holotrace::test
