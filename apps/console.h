#pragma once

#include <memory>
#include <string>

#include "holotrace/data/report.h"
#include "holotrace/run/stage.h"

namespace holotrace {

/// Output of the program on the terminal (stderr): one progress bar per stage on a terminal, no bars in a
/// pipe, and every warning.
class Console {
 public:
  explicit Console(bool is_quiet);

  /// From here on, what happens is also in a file in that folder, for `holotrace view` (io/files/progress_file.h).
  void keep_progress_in(const std::string& folder);

  /// From here on, the stages are also in that report file (io/report_file.h), written by finish(); "": none.
  void keep_report(const std::string& path);

  /// The observer of a stage; its bar ends when the next stage starts or on finish().
  Observer watch(const std::string& stage);

  /// Clears the line of the bar, for a line of output there; the bar is drawn again at the stage's next step.
  void clear();

  /// Ends the last stage: its bar, and its time in the report.
  void finish();

  StageObserver stages() {
    return [this](const std::string& stage) { return watch(stage); };
  }

 private:
  struct Bar;
  struct KeptProgress;
  struct KeptReport;
  bool is_terminal_;
  std::shared_ptr<Bar> bar_;
  std::shared_ptr<KeptProgress> kept_;
  std::shared_ptr<KeptReport> report_;
};

}  // namespace holotrace
