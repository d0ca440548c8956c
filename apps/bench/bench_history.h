#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bench/bench.h"

namespace holotrace {

/// What got slower since earlier runs.
struct SlowerStage {
  std::string stage, job;
  double before = 0, now = 0;  ///< seconds; before: the median of earlier runs
  double ratio = 0;            ///< of the time, relative to the ceilings of each run where there are any
};

/// A file of rows of earlier runs of `holotrace bench`: one line of JSON each, with the date, commit, version, processor, number
/// of threads, group, stage, job, median time [s] and part of the ceiling.
///
/// A row is compared with the median of the last five rows of the same stage and job that the same processor measured with as many
/// threads. Rows with a ceiling are compared as parts of it, which a machine that is slower at the moment does not change.
class BenchHistory {
 public:
  /// Reads the file, if it is there. @throws Error if a line is not such a row, naming it
  explicit BenchHistory(std::string path);

  /// Stages that take more than `slower` times as long as before.
  std::vector<SlowerStage> find_slower(const std::vector<std::pair<std::string, BenchRow>>& rows, int threads,
                                       double slower) const;

  /// Number of earlier rows of this processor with as many threads.
  size_t comparable(int threads) const;

  /// Appends the rows to the file. @throws Error as write_text does
  void append(const std::vector<std::pair<std::string, BenchRow>>& rows, int threads) const;

 private:
  std::string path_, text_;
  std::vector<nlohmann::ordered_json> earlier_;
};

}  // namespace holotrace
