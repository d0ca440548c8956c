#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "holotrace/data/chart.h"

namespace holotrace {

/// How long the benchmark may take.
struct BenchOptions {
  bool is_quick = false;        ///< the small jobs alone
  double seconds_per_row = 2;   ///< runs are repeated for so long, seven times at most
  double longest_seconds = 15;  ///< a job that should take longer is left out
};

/// A stage on a job: what it took, and what part of the ceiling it reached.
struct BenchRow {
  std::string stage{};  ///< "tiled AVX2"
  std::string job{};    ///< "1920x1080, 1e4 waves, 0.19-0.21 m"
  double seconds = 0;   ///< of one run: the median
  int runs = 0;
  double rate = 0;                 ///< in `unit` per second
  std::string unit{};              ///< "waves·pixels"
  double ceiling_rate = 0;         ///< in `unit` per second: what the machine could do at best; 0: no ceiling known
  std::string ceiling{};           ///< what bounds it: "multiply-adds AVX2"
  double of_ceiling = 0;           ///< rate / ceiling_rate, each run by the ceiling measured beside it
  double error = -1;               ///< relative L2 error against the exact sum; -1: not measured
  std::string left_out{};          ///< why it was not run
  nlohmann::ordered_json facts{};  ///< what the stage said of its work
};

/// A row and the work that fills it.
struct BenchStep {
  std::string name;
  std::function<BenchRow()> run;
};

/// The median of several runs, each beside a measurement of what bounds it.
struct Timing {
  double seconds = 0, ceiling_rate = 0, of_ceiling = 0;
  int runs = 0;
};

/// Times `work`, which does `amount` units: once to see how long it takes, then as often as the options allow.
/// @param ceiling  units per second that the machine could do at best, measured anew around each run; may be empty
Timing time_work(const BenchOptions& options, const std::function<void()>& work, double amount,
                 const std::function<double()>& ceiling = {});

/// A row with what was timed.
BenchRow make_row(const std::string& stage, const std::string& job, const Timing& timing, double amount,
                  const std::string& unit, const std::string& ceiling = "");

/// 1e4, 5e5: a round number in short.
std::string short_count(int64_t count);

// The steps of each group, in the order of the table.
std::vector<BenchStep> exact_steps(const BenchOptions& options);
std::vector<BenchStep> tiled_steps(const BenchOptions& options);
std::vector<BenchStep> planes_steps(const BenchOptions& options);
std::vector<BenchStep> layers_steps(const BenchOptions& options);
std::vector<BenchStep> triangles_steps(const BenchOptions& options);
std::vector<BenchStep> auto_steps(const BenchOptions& options);
std::vector<BenchStep> trace_steps(const BenchOptions& options);
std::vector<BenchStep> accelerators_steps(const BenchOptions& options);
std::vector<BenchStep> propagate_steps(const BenchOptions& options);
std::vector<BenchStep> show_steps(const BenchOptions& options);
std::vector<BenchStep> quality_steps(const BenchOptions& options);

/// The time of a ray against the number of triangles, of the rows of accelerators_steps.
Chart accelerators_chart(const std::vector<BenchRow>& rows);

}  // namespace holotrace
