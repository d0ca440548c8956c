#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <set>
#include <string>

#include "holotrace/data/checkpoint.h"

namespace holotrace {

/// Whether Ctrl-C stopped a job that keeps a checkpoint.
bool was_interrupted();

/// The files of the flag --checkpoint: the state of the iterations of each hologram, or of each set of frames.
class Checkpoints {
 public:
  static void add_flag(CLI::App& command, std::string& path);

  /// @param path  of the first file, .h5; "": none is kept
  /// @throws Error  if it cannot be written
  explicit Checkpoints(std::string path);

  bool are_kept() const { return !path_.empty(); }

  /// The checkpoint of the i-th hologram: saved once a minute and on Ctrl-C, which then stops the program. While it
  /// exists, a second Ctrl-C stops the program at once.
  Checkpoint of(size_t i) const;

  /// Removes the files of a finished job: those that were saved or read.
  void remove() const;

 private:
  std::string path_;
  std::shared_ptr<std::set<std::string>> used_ = std::make_shared<std::set<std::string>>();
};

}  // namespace holotrace
