#include "holotrace/repeated_stages.h"

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
  for (const std::string& sentence : once.warnings)
    if (std::find(entry.warnings.begin(), entry.warnings.end(), sentence) == entry.warnings.end())
      entry.warnings.push_back(sentence);
}

}  // namespace

void RepeatedStages::merge(StageReport&& once) {
  auto& stages = report_.stages;
  const auto entry = std::find_if(stages.begin(), stages.end(), [&](const auto& s) { return s.stage == once.stage; });
  if (entry == stages.end()) {
    StageReport first{once.stage, 0, {}, {}, once.curves};
    if (holograms_ > 1) first.facts.emplace_back("holograms", Fact(holograms_));
    stages.push_back(std::move(first));
    add(once, stages.back());
  } else {
    add(once, *entry);
  }
}

}  // namespace holotrace
