#include "holotrace/base/observer.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace holotrace {

void merge_fact(std::vector<std::pair<std::string, Fact>>& facts, const std::string& name, const Fact& value) {
  const auto found = std::find_if(facts.begin(), facts.end(), [&](const auto& fact) { return fact.first == name; });
  if (found == facts.end()) {
    facts.emplace_back(name, value);
    return;
  }
  constexpr std::array<std::string_view, 5> counts{"waves", "waves_pixels", "waves_cut", "triangles", "parts"};
  Fact& present = found->second;
  if (std::find(counts.begin(), counts.end(), name) != counts.end()) {
    std::get<int64_t>(present) += std::get<int64_t>(value);
  } else if (name == "predicted_seconds") {
    std::get<double>(present) += std::get<double>(value);
  } else if (name == "expected_error") {
    std::get<double>(present) = std::max(std::get<double>(present), std::get<double>(value));
  } else if (name == "method") {
    std::string& methods = std::get<std::string>(present);
    const std::string& method = std::get<std::string>(value);
    if ((" and " + methods + " and ").find(" and " + method + " and ") == std::string::npos)
      methods += " and " + method;
  }
}

}  // namespace holotrace
