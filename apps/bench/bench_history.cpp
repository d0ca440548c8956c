#include "bench/bench_history.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iterator>
#include <sstream>

#include "bench/commit.h"
#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
#include "holotrace/io/files/file.h"
#include "holotrace/io/files/text.h"

namespace holotrace {
namespace {

using Json = nlohmann::ordered_json;

bool is_row(const Json& json) {
  if (!json.is_object()) return false;
  const auto has = [&](const char* name, auto is_kind) { return json.contains(name) && is_kind(json[name]); };
  const auto is_text = [](const Json& j) { return j.is_string(); };
  const auto is_number = [](const Json& j) { return j.is_number(); };
  for (const char* name : {"processor", "device", "group", "stage", "job"})
    if (!has(name, is_text)) return false;
  return has("threads", is_number) && has("seconds", is_number) && json["seconds"] > 0 &&
         (!json.contains("of_ceiling") || (is_number(json["of_ceiling"]) && json["of_ceiling"] > 0));
}

// The device of a row: the one that a stage names, or the processor.
std::string device_of(const BenchRow& row) {
  return row.facts.contains("device") ? row.facts["device"].get<std::string>() : cpu_name();
}

// Whether a row is of the same stage and job on the same machine.
bool is_of(const Json& json, const BenchRow& row, int threads) {
  return json["processor"] == cpu_name() && json["threads"] == threads && json["device"] == device_of(row) &&
         json["group"] == row.group && json["stage"] == row.stage && json["job"] == row.job;
}

// Whether the part of the ceiling tells more than the time: not if the ceiling is this program's own transform.
bool has_outer_ceiling(const BenchRow& row) { return row.of_ceiling > 0 && !row.ceiling.starts_with("FFT"); }

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t middle = values.size() / 2;
  return values.size() % 2 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

}  // namespace

BenchHistory::BenchHistory(std::string path) : path_(std::move(path)) {
  if (!is_there(path_)) return;
  require(is_file(path_), "{} is not a file on a disk, in which the times of earlier benches can be; name another file",
          path_);
  // Not by read_text: a command's input may not be its output, too.
  std::ifstream file(path_, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(file), {});
  require(file.is_open() && !file.bad(), "cannot read {}; check its permissions, or name another file", path_);
  ends_in_line_ = text.empty() || text.back() == '\n';
  std::istringstream lines(text);
  std::string line;
  for (size_t number = 1; std::getline(lines, line); ++number) {
    if (line.empty()) continue;
    earlier_.push_back(parse_json_if_sound(line));
    require(is_row(earlier_.back()),
            "{}: line {} is not a row of holotrace bench --history; name another file, or remove the line", path_,
            number);
  }
}

BenchComparison BenchHistory::compare(const std::vector<BenchRow>& rows, int threads, double slower) const {
  constexpr size_t most = 5;  // earlier rows of a stage
  BenchComparison comparison;
  for (const BenchRow& row : rows) {
    if (!(row.seconds > 0)) continue;
    const bool is_part = has_outer_ceiling(row);
    const char* const measure = is_part ? "of_ceiling" : "seconds";
    std::vector<double> values;
    for (auto json = earlier_.rbegin(); json != earlier_.rend() && values.size() < most; ++json)
      if (is_of(*json, row, threads) && json->contains(measure)) values.push_back((*json)[measure]);
    if (values.empty()) continue;
    ++comparison.compared;
    const double before = median_of(values), now = is_part ? row.of_ceiling : row.seconds;
    const double ratio = is_part ? before / now : now / before;
    if (ratio > slower) comparison.slower.push_back({row.stage, row.job, is_part, before, now, ratio});
  }
  return comparison;
}

void BenchHistory::append(const std::vector<BenchRow>& rows, int threads) const {
  std::string text = ends_in_line_ ? "" : "\n";
  const std::string date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  for (const BenchRow& row : rows) {
    if (!(row.seconds > 0)) continue;
    Json json{{"date", date},
              {"commit", source_commit},
              {"version", HOLOTRACE_VERSION},
              {"processor", cpu_name()},
              {"device", device_of(row)},
              {"threads", threads},
              {"group", row.group},
              {"stage", row.stage},
              {"job", row.job},
              {"seconds", row.seconds}};
    if (has_outer_ceiling(row)) json["of_ceiling"] = row.of_ceiling;
    text += json.dump() + "\n";
  }
  // In one piece at the end, so that benches at the same time keep each other's rows.
  std::ofstream file(path_, std::ios::binary | std::ios::app);
  file.write(text.data(), std::streamsize(text.size()));
  file.close();
  require(!file.fail(), "cannot write {}; check its permissions and the space on its disk", path_);
}

}  // namespace holotrace
