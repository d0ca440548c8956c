#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/chosen.h"

namespace holotrace {

/// The record of one stage: its time, its facts and its warnings.
struct StageReport {
  std::string stage;
  double seconds = 0;
  std::vector<std::pair<std::string, Fact>> facts;
  std::vector<std::string> warnings;
  std::vector<std::pair<std::string, std::vector<double>>> curves;  ///< values per iteration, by name
};

/// The record of a run, stage by stage.
struct Report {
  int64_t seed = 0;
  std::vector<StageReport> stages;
  std::vector<Chosen> chosen{};  ///< what the job did not give
};

}  // namespace holotrace
