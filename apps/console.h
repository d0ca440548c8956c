#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/message_text.h"
#include "holotrace/data/report.h"
#include "holotrace/io/files/output_set.h"
#include "holotrace/run/stage.h"

namespace holotrace {

/// Prints on standard error. A message that cannot be written, because a disk is full or a terminal is gone, is lost: it
/// ends no work.
template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  std::fputs(fmt::format(format, std::forward<Args>(args)...).c_str(), stderr);
}

/// Prints warnings on standard error.
inline void say_warnings(const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) say("warning: {}\n", printable(sentence));
}

/// An observer that prints warnings on standard error as they come.
inline Observer warnings_on_terminal() {
  Observer observer;
  observer.on_warning = [](const std::string& sentence) { say_warnings({sentence}); };
  return observer;
}

/// Output of the program on the terminal (stderr): one progress bar per stage on a terminal, a line every 30 s of a stage in a
/// pipe, and every warning.
class Console {
 public:
  explicit Console(bool is_quiet);

  /// From here on, what happens is also in a file in that folder, for `holotrace view` (io/files/progress_file.h).
  void keep_progress_in(const std::string& folder);

  /// From here on, the stages are also in that report file (io/run_folder.h), written by finish(); "": none.
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
  bool is_quiet_, is_terminal_;
  std::shared_ptr<Bar> bar_;
  std::shared_ptr<KeptProgress> kept_;
  std::shared_ptr<KeptReport> report_;
};

/// Prints what was chosen for a job that did not say it.
void print_chosen(const std::vector<Chosen>& chosen);

/// Prints what a run did: a line per stage with its seconds and its main figures, its views in words, and the files that it
/// wrote.
void print_summary(const Report& report, const std::string& folder, const FileRecord& files, bool is_draft);

}  // namespace holotrace
