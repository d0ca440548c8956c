#include "run_summary.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "holotrace/io/describe_run.h"
#include "holotrace/io/report_file.h"

namespace holotrace {
namespace {

struct Figure {
  const char* fact;
  const char* text;  // with a place for the number
};

// What a person asks for first. The report has all facts.
constexpr std::array figures{Figure{"waves", "{:.0f} waves"},
                             Figure{"efficiency", "{:.2f} of the panel's light leaves it"}};

std::optional<double> number_of(const StageReport& stage, const char* name) {
  for (const auto& [fact, value] : stage.facts) {
    if (fact != name) continue;
    if (const auto* number = std::get_if<double>(&value)) return *number;
    if (const auto* count = std::get_if<int64_t>(&value)) return double(*count);
  }
  return std::nullopt;
}

const std::vector<double>* curve_of(const StageReport& stage, const char* name) {
  for (const auto& [curve, values] : stage.curves)
    if (curve == name) return &values;
  return nullptr;
}

// Where the light of holograms for eyes goes.
void print_light_of_eyes(const StageReport& stage) {
  const auto *in_box = curve_of(stage, "light_in_eyebox"), *in_pupil = curve_of(stage, "light_in_pupil"),
             *beside = curve_of(stage, "light_beside_eyebox");
  if (!in_box || !in_pupil || !beside) return;
  for (size_t i = 0; i < in_box->size(); ++i)
    fmt::print(
        "    {}{:.1f} % of the panel's light reaches the eyebox, {:.1f} % a pupil in its middle, {:.1f} % a pupil just outside\n",
        in_box->size() > 1 ? fmt::format("eye {}: ", i + 1) : "", 100 * (*in_box)[i], 100 * (*in_pupil)[i],
        100 * (*beside)[i]);
}

}  // namespace

void print_summary(const Report& report, const std::string& folder, const FileRecord& files) {
  std::vector<std::string> chosen;
  for (const Chosen& one : report.chosen) chosen.push_back(one.parameter + " " + one.value);
  if (!chosen.empty()) fmt::print("chosen: {}\n", fmt::join(chosen, ", "));
  double total = 0;
  for (const StageReport& stage : report.stages) {
    std::vector<std::string> texts;
    for (const Figure& figure : figures)
      if (const auto number = number_of(stage, figure.fact))
        texts.push_back(fmt::format(fmt::runtime(figure.text), *number));
    fmt::print("{:<28} {:>9.2f} s  {}\n", stage.stage, stage.seconds, fmt::join(texts, ", "));
    print_light_of_eyes(stage);
    total += stage.seconds;
  }
  fmt::print("{:<28} {:>9.2f} s\n", "all stages", total);
  for (const ViewWords& view : views_in_words(report_json(report)))
    fmt::print("{}: {}\n{}", view.name, view.nearness, view.light.empty() ? "" : "    " + view.light + "\n");
  std::vector<std::string> names{"report.json"};
  for (const auto& [name, bytes] : files) names.push_back(name);
  std::sort(names.begin(), names.end());
  fmt::print("written to {}: {}\n", folder, fmt::join(names, ", "));
}

}  // namespace holotrace
