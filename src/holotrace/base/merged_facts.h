#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/observer.h"

namespace holotrace {

/// Adds a fact of one part of a task to those of the parts before: counts "waves" and "waves_pixels" and "predicted_seconds" are summed,
/// of "expected_error" the largest is kept, different methods are listed; of all others the first is kept.
inline void merge_fact(std::vector<std::pair<std::string, Fact>>& facts, const std::string& name, const Fact& value) {
  const auto found = std::find_if(facts.begin(), facts.end(), [&](const auto& fact) { return fact.first == name; });
  if (found == facts.end()) {
    facts.emplace_back(name, value);
    return;
  }
  Fact& present = found->second;
  if (name == "waves" || name == "waves_pixels")
    std::get<int64_t>(present) += std::get<int64_t>(value);
  else if (name == "predicted_seconds")
    std::get<double>(present) += std::get<double>(value);
  else if (name == "expected_error")
    std::get<double>(present) = std::max(std::get<double>(present), std::get<double>(value));
  else if (name == "method" && std::get<std::string>(present).find(std::get<std::string>(value)) == std::string::npos)
    std::get<std::string>(present) += ", " + std::get<std::string>(value);
}

}  // namespace holotrace
