#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "holotrace/base/error.h"

namespace holotrace::test {

/// A path for a test's own file. A file left there by an earlier run is gone, and its sidecar too.
inline std::string temporary(const std::string& name) {
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) /
                                       ("holotrace_" + std::string(info->test_suite_name()) + "_" + info->name());
  std::filesystem::create_directories(folder);
  const auto path = folder / name;
  std::filesystem::remove_all(path);
  std::filesystem::remove_all(std::filesystem::path(path).replace_extension(".json"));
  return path.string();
}

/// Writes a test's input.
inline std::string make_file(const std::string& name, const std::string& bytes) {
  const std::string path = temporary(name);
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

/// The sentence of the Error that `run` throws; "no error" where it throws none.
template <class Run>
std::string error_of(const Run& run) {
  try {
    run();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace holotrace::test
