#pragma once

#include <string>

#include "holotrace/data/report.h"
#include "holotrace/io/files/output_set.h"

namespace holotrace {

/// Prints what a run did: a line per stage with its seconds and its main figures, its views in words, and the files that it
/// wrote.
void print_summary(const Report& report, const std::string& folder, const FileRecord& files);

}  // namespace holotrace
