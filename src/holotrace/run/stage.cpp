#include "holotrace/run/stage.h"

#include <algorithm>

#include "holotrace/base/observer.h"

namespace holotrace {
namespace {

void add(const StageReport& once, StageReport& entry) {
  entry.seconds += once.seconds;
  for (const auto& [name, value] : once.facts) merge_fact(entry.facts, name, value);
  for (const auto& curve : once.curves)
    if (std::none_of(entry.curves.begin(), entry.curves.end(), [&](const auto& c) { return c.first == curve.first; }))
      entry.curves.push_back(curve);
  for (const std::string& sentence : once.warnings)
    if (std::find(entry.warnings.begin(), entry.warnings.end(), sentence) == entry.warnings.end())
      entry.warnings.push_back(sentence);
}

}  // namespace

bool RepeatedStages::has_run(const std::string& name) const {
  return std::any_of(report_.stages.begin(), report_.stages.end(), [&](const auto& s) { return s.stage == name; });
}

void RepeatedStages::merge(StageReport&& once) {
  auto& stages = report_.stages;
  const auto entry = std::find_if(stages.begin(), stages.end(), [&](const auto& s) { return s.stage == once.stage; });
  if (entry == stages.end()) {
    StageReport first{once.stage, 0, {}, {}, {}};
    if (holograms_ > 1) first.facts.emplace_back("holograms", Fact(holograms_));
    stages.push_back(std::move(first));
    add(once, stages.back());
  } else {
    add(once, *entry);
  }
}

}  // namespace holotrace
