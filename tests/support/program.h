#pragma once

#include <sys/types.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace holotrace::test {

/// What a run of the program left behind.
struct Outcome {
  int exit_code = 0;  ///< 128 + signal where a signal ended it
  std::string out, err;
};

/// A folder of a test's own, gone with it, in which the program runs with a cache folder of its own: no
/// test sees the files or the FFTW wisdom of another.
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

  /// Every file and folder here, hidden ones too, relative to the folder; the cache is left out.
  std::set<std::string> names() const;

  /// Runs `holotrace arguments…` in this folder, its output in pipes, and waits for its end.
  Outcome run(const std::vector<std::string>& arguments) const;

  /// The same under a launcher: `launcher… holotrace arguments…`, found on the PATH.
  Outcome run_under(const std::vector<std::string>& launcher, const std::vector<std::string>& arguments) const;
  pid_t start_under(const std::vector<std::string>& launcher, const std::vector<std::string>& arguments) const;

  /// Starts it and does not wait: for a test that kills it. Its output is dropped.
  pid_t start(const std::vector<std::string>& arguments) const;

  /// A file of the program's cache folder, such as summation_rates.json.
  std::string cache_path(const std::string& name) const { return (cache_ / "holotrace" / name).string(); }

  /// Forgets FFTW's plans, as on a machine where the program never ran.
  void clear_cache() const;

 private:
  std::filesystem::path folder_, cache_;
};

/// Bytes of a file. Fails the test where there is none.
std::string bytes_of(const std::string& path);

}  // namespace holotrace::test
