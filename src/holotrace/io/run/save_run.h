#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "holotrace/io/files/output_set.h"
#include "holotrace/run/pipeline.h"

namespace holotrace {

/// The paths of the files that a run writes into its folder, the first of each kind.
std::vector<std::string> run_paths(const std::string& folder);

/// The files of a run, and a sentence for each file of a user that was set aside.
struct SavedRun {
  FileRecord files;
  std::vector<std::string> notes;
};

/// Writes all that a run computed into its folder, where it replaces what an earlier run left (write_together). If the
/// program is killed while the files get their names, report.json says that the folder is incomplete.
/// @param watch          of the stages "save the sweep" and "chart"
/// @param before_naming  is called before the files get their names; what it returns lives until they have them
SavedRun save_run(const std::string& folder, const RunResults& results, const Job& job, const StageObserver& watch = {},
                  const std::function<std::shared_ptr<void>()>& before_naming = {});

}  // namespace holotrace
