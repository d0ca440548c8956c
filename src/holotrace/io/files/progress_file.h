#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/io/files/new_file.h"

namespace holotrace {

/// How far a running job is, in a hidden file in its output folder, which others may read while it lives. The file
/// disappears with its program; if that is killed, the next one removes it (remove_abandoned).
///
/// It holds JSON, {stage, fraction, seconds, status, history}: history has pairs [fraction, status] of the stage, at most
/// most_entries, as evenly as they came. It is written at most twice a second. A file that cannot be written is no error:
/// the job goes on without it. May be called from any thread, if one at a time.
class ProgressFile {
 public:
  static constexpr size_t most_entries = 500;

  explicit ProgressFile(const std::string& folder);

  void begin_stage(const std::string& stage);
  void update(double fraction);
  void tell(const std::string& status);

 private:
  using Clock = std::chrono::steady_clock;
  void write();

  std::unique_ptr<NewFile> file_;
  std::string stage_, status_;
  double fraction_ = 0;
  std::vector<std::pair<double, std::string>> history_;
  size_t calls_ = 0, step_ = 1, longest_ = 0;
  Clock::time_point start_ = Clock::now(), written_{};
};

/// The text of the progress file of a program that runs and writes to that folder; nothing if there is none.
std::optional<std::string> running_progress(const std::string& folder);

}  // namespace holotrace
