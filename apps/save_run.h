#pragma once

#include <string>
#include <vector>

#include "holotrace/io/files/output_set.h"
#include "holotrace/run/pipeline.h"

namespace holotrace {

class Console;

/// The paths of the files that a run writes into its folder, the first of each kind.
std::vector<std::string> run_paths(const std::string& folder);

/// Writes all that a run computed into its folder, where it replaces what an earlier run left (write_together). If the
/// program is killed while the files get their names, report.json says that the folder is incomplete.
/// @return  the files
FileRecord save_run(const std::string& folder, const Boxes& boxes, const Job& job, Console& console);

}  // namespace holotrace
