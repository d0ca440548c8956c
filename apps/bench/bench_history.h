#pragma once

#include <string>
#include <vector>

#include "bench/bench.h"

namespace holotrace {

/// What got slower since earlier runs.
struct SlowerStage {
  std::string stage, job;
  bool is_part = false;        ///< what is compared: the part of the ceiling, or the time [s]
  double before = 0, now = 0;  ///< before: the median of earlier rows
  double ratio = 0;            ///< of the times
};

struct BenchComparison {
  int compared = 0;  ///< stages of this run that have earlier rows
  std::vector<SlowerStage> slower;
};

/// A file of rows of earlier runs of `holotrace bench`: one line of JSON each, with the date, commit, version, processor, device,
/// number of threads, group, stage, job, median time [s], and part of the ceiling.
///
/// A row is compared with the median of the last five rows of the same stage and job that the same processor or device measured
/// with as many threads. What is compared is the part of the ceiling, which a machine that is slower at the moment does not change,
/// where the ceiling is not this program's own transform; else the time.
class BenchHistory {
 public:
  /// Reads the file, if it is there. @throws Error if it cannot be read, or a line is not such a row, naming it
  explicit BenchHistory(std::string path);

  /// Finds the stages that take more than `slower` times as long as before.
  BenchComparison compare(const std::vector<BenchRow>& rows, int threads, double slower) const;

  /// Adds the rows to the end of the file. @throws Error if it cannot be written
  void append(const std::vector<BenchRow>& rows, int threads) const;

 private:
  std::string path_;
  bool ends_in_line_ = true;  // the file is empty, or its last line has an end
  std::vector<nlohmann::ordered_json> earlier_;
};

}  // namespace holotrace
