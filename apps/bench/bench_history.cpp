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
using GroupedRow = std::pair<std::string, BenchRow>;

bool is_row(const Json& json) {
  if (!json.is_object()) return false;
  const auto has = [&](const char* name, auto is_kind) { return json.contains(name) && is_kind(json[name]); };
  const auto is_text = [](const Json& j) { return j.is_string(); };
  const auto is_number = [](const Json& j) { return j.is_number(); };
  for (const char* name : {"processor", "group", "stage", "job"})
    if (!has(name, is_text)) return false;
  return has("threads", is_number) && has("seconds", is_number) && json["seconds"] > 0 &&
         (!json.contains("of_ceiling") || (is_number(json["of_ceiling"]) && json["of_ceiling"] > 0));
}

bool is_from_here(const Json& row, int threads) { return row["processor"] == cpu_name() && row["threads"] == threads; }

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + int64_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

BenchHistory::BenchHistory(std::string path) : path_(std::move(path)) {
  // Not by read_text: a command's input may not be its output, too.
  std::ifstream file(path_, std::ios::binary);
  text_.assign(std::istreambuf_iterator<char>(file), {});
  if (!text_.empty() && text_.back() != '\n') text_ += '\n';
  std::istringstream lines(text_);
  std::string line;
  for (size_t number = 1; std::getline(lines, line); ++number) {
    if (line.empty()) continue;
    earlier_.push_back(parse_json_if_sound(line));
    require(is_row(earlier_.back()),
            "{}: line {} is not a row of holotrace bench --history; name another file, or remove the line", path_,
            number);
  }
}

size_t BenchHistory::comparable(int threads) const {
  return size_t(
      std::count_if(earlier_.begin(), earlier_.end(), [&](const Json& row) { return is_from_here(row, threads); }));
}

std::vector<SlowerStage> BenchHistory::find_slower(const std::vector<GroupedRow>& rows, int threads,
                                                   double slower) const {
  constexpr size_t most = 5;  // earlier rows of a stage
  std::vector<SlowerStage> found;
  for (const auto& [group, row] : rows) {
    if (!(row.seconds > 0)) continue;
    std::vector<double> seconds, parts;
    for (auto before = earlier_.rbegin(); before != earlier_.rend() && seconds.size() < most; ++before) {
      const Json& json = *before;
      if (!is_from_here(json, threads) || json["group"] != group || json["stage"] != row.stage ||
          json["job"] != row.job)
        continue;
      seconds.push_back(json["seconds"]);
      if (json.contains("of_ceiling")) parts.push_back(json["of_ceiling"]);
    }
    if (seconds.empty()) continue;
    const double before = median_of(seconds);
    const bool has_parts = row.of_ceiling > 0 && parts.size() == seconds.size();
    const double ratio = has_parts ? median_of(parts) / row.of_ceiling : row.seconds / before;
    if (ratio > slower) found.push_back({row.stage, row.job, before, row.seconds, ratio});
  }
  return found;
}

void BenchHistory::append(const std::vector<GroupedRow>& rows, int threads) const {
  std::string text = text_;
  const std::string date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  for (const auto& [group, row] : rows) {
    if (!(row.seconds > 0)) continue;
    Json json{
        {"date", date},          {"commit", source_commit}, {"version", HOLOTRACE_VERSION}, {"processor", cpu_name()},
        {"threads", threads},    {"group", group},          {"stage", row.stage},           {"job", row.job},
        {"seconds", row.seconds}};
    if (row.of_ceiling > 0) json["of_ceiling"] = row.of_ceiling;
    text += json.dump() + "\n";
  }
  write_text(path_, text);
}

}  // namespace holotrace
