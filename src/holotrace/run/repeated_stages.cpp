#include "holotrace/run/repeated_stages.h"

#include <algorithm>

namespace holotrace {
namespace {

void add(const StageReport& once, StageReport& entry) {
  entry.seconds += once.seconds;
  for (const auto& fact : once.facts) {
    const auto found = std::find_if(entry.facts.begin(), entry.facts.end(),
                                    [&](const auto& present) { return present.first == fact.first; });
    if (found == entry.facts.end())
      entry.facts.push_back(fact);
    else if (fact.first == "waves" || fact.first == "waves_pixels")
      std::get<int64_t>(found->second) += std::get<int64_t>(fact.second);
  }
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
