#pragma once

#include <sys/types.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace holotrace::test {

/// The results of a run of the program.
struct Outcome {
  int exit_code = 0;  ///< 128 + signal if a signal ended it
  std::string out, err;
};

/// A folder for one test, removed afterwards, in which the program runs with a separate cache folder: no
/// test sees the files of another.
class Workplace {
 public:
  Workplace();
  ~Workplace();
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string read(const std::string& name) const;
  bool has(const std::string& name) const { return std::filesystem::exists(folder_ / name); }

  /// Writes an input and returns its path.
  std::string write(const std::string& name, const std::string& bytes) const;

  /// Every file and folder here, also hidden ones, relative to the folder; without the cache.
  std::set<std::string> names() const;

  /// Runs `holotrace arguments…` in this folder, records its output, and waits for its end.
  Outcome run(const std::vector<std::string>& arguments) const;

  /// The same under a launcher: `launcher… holotrace arguments…`, found on the PATH.
  Outcome run_under(const std::vector<std::string>& launcher, const std::vector<std::string>& arguments) const;
  pid_t start_under(const std::vector<std::string>& launcher, const std::vector<std::string>& arguments) const;

  /// Starts the program without waiting, for a test that kills it. Its output is dropped.
  pid_t start(const std::vector<std::string>& arguments) const;

  /// A file of the program's cache folder, such as summation_rates.json.
  std::string cache_path(const std::string& name) const { return (cache_ / "holotrace" / name).string(); }

  /// Removes what the program keeps, as on a machine where it never ran.
  void clear_cache() const;

 private:
  std::filesystem::path folder_, cache_;
};

/// Runs the program; the test fails unless it succeeds.
void expect_success(const Workplace& work, const std::vector<std::string>& arguments);

/// The same; the program must not warn either.
void expect_quiet_success(const Workplace& work, const std::vector<std::string>& arguments);

/// Bytes of a file. The test fails if there is none.
std::string bytes_of(const std::string& path);

}  // namespace holotrace::test
