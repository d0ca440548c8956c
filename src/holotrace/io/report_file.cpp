#include "holotrace/io/report_file.h"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "holotrace/base/fft.h"
#include "holotrace/io/files/file.h"

namespace holotrace {

namespace {

using Json = nlohmann::ordered_json;

Json versions() { return {{"holotrace", HOLOTRACE_VERSION}, {"fftw", fft_library_version()}}; }

// A report as JSON; empty if there is none at the path. It is an output, so read_text, which notes inputs, is not used.
nlohmann::json read_report(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return nlohmann::json::object();
  std::ifstream file(path, std::ios::binary);
  return nlohmann::json::parse(file, nullptr, false);
}

}  // namespace

nlohmann::ordered_json report_json(const Report& report) {
  nlohmann::ordered_json json;
  json["versions"] = versions();
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

void save_report(const std::string& path, const Report& report, const FileRecord& files) {
  nlohmann::ordered_json json = report_json(report);
  if (!files.empty()) {
    json["complete"] = true;
    json["files"] = record_json(files);
  }
  write_text(path, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void save_incomplete_report(const std::string& path, const FileRecord& files) {
  const nlohmann::ordered_json json{
      {"versions", versions()}, {"complete", false}, {"files", record_json(files)}, {"stages", Json::array()}};
  write_text(path, json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

bool is_report(const std::string& path) { return read_report(path).contains("versions"); }

FileRecord report_record(const std::string& path) {
  const nlohmann::json report = read_report(path);
  return report.contains("versions") && report.contains("files") ? record_from(report["files"]) : FileRecord();
}

}  // namespace holotrace
