#pragma once

#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/error.h"
#include "save_views.h"

namespace holotrace {

/// Checks that outputs do not overwrite each other.
/// @param outputs  flags and the paths that they give; flags without a path are skipped
/// @throws Error   if two of them name one file
inline void check_distinct(const std::vector<std::pair<std::string, std::string>>& outputs) {
  for (size_t i = 0; i < outputs.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      require(
          outputs[i].second.empty() || outputs[j].second.empty() || !is_same_file(outputs[i].second, outputs[j].second),
          "expected a file each for {} and {}, got {} for both", outputs[j].first, outputs[i].first, outputs[i].second);
}

}  // namespace holotrace
