#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "holotrace/data/report.h"

namespace holotrace {

/// The report as JSON: versions, seed, and for each stage its seconds, facts and warnings. A fact that is
/// not finite becomes null.
nlohmann::ordered_json report_json(const Report& report);

/// Writes the report to `path`, completely or not at all.
/// @throws Error  if the file cannot be written
void save_report(const std::string& path, const Report& report);

}  // namespace holotrace
