#include "holotrace/io/report_file.h"

#include <nlohmann/json.hpp>

#include "holotrace/base/fft.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

nlohmann::ordered_json report_json(const Report& report) {
  nlohmann::ordered_json json;
  json["versions"] = {{"holotrace", HOLOTRACE_VERSION}, {"fftw", fft_library_version()}};
  json["seed"] = report.seed;
  double total = 0;
  for (const StageReport& stage : report.stages) {
    nlohmann::ordered_json entry{{"stage", stage.stage}, {"seconds", stage.seconds}};
    for (const auto& [name, fact] : stage.facts) std::visit([&, &key = name](const auto& v) { entry[key] = v; }, fact);
    for (const auto& [name, values] : stage.curves) entry[name] = values;
    entry["warnings"] = stage.warnings;
    json["stages"].push_back(entry);
    total += stage.seconds;
  }
  json["seconds"] = total;
  return json;
}

void save_report(const std::string& path, const Report& report) {
  write_text(path, report_json(report).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace holotrace
