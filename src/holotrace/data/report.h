#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/observer.h"

namespace holotrace {

/// What one stage did: its time, the facts it stated, its doubts.
struct StageReport {
  std::string stage;
  double seconds = 0;
  std::vector<std::pair<std::string, Fact>> facts;
  std::vector<std::string> warnings;
  std::vector<std::pair<std::string, std::vector<double>>> curves;  ///< of iterations
};

/// What a run did, stage by stage.
struct Report {
  int64_t seed = 0;
  std::vector<StageReport> stages;
};

}  // namespace holotrace
