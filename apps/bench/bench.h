#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "holotrace/data/chart.h"
#include "holotrace/data/params/device.h"

namespace holotrace {

/// Limits on the duration of the benchmark.
struct BenchOptions {
  bool is_quick = false;        ///< only the small jobs
  double seconds_per_row = 2;   ///< total time of the repeated runs of a row [s]; at most seven runs
  double longest_seconds = 15;  ///< a job that would take longer is left out [s]
  DeviceChoice device{};        ///< an OpenCL device whose stages are timed; otherwise those of the processor
};

/// A stage on a job: its time, and the fraction of the ceiling that it reached.
struct BenchRow {
  std::string group{};   ///< group of stages, such as "tiled"; set when the row is made
  std::string stage{};   ///< stage, such as "tiled AVX2"
  std::string job{};     ///< job, such as "1920x1080, 1e4 waves, 0.19-0.21 m"; the same in each run
  std::string result{};  ///< what was found besides the time, such as "13.3 dB"; or empty
  double seconds = 0;    ///< median time of one run [s]
  int runs = 0;
  double rate = 0;                 ///< in `unit` per second
  std::string unit{};              ///< such as "waves·pixels"
  double ceiling_rate = 0;         ///< highest possible rate of the machine, in `unit` per second; 0: unknown
  std::string ceiling{};           ///< what limits it, such as "multiply-adds AVX2"
  double of_ceiling = 0;           ///< rate / ceiling_rate; each run uses the ceiling measured beside it
  double error = -1;               ///< relative L2 error against the exact sum; -1: not measured
  std::string left_out{};          ///< the reason if it was not run; else ""
  nlohmann::ordered_json facts{};  ///< facts that the stage reported
};

/// A row and the function that fills it.
struct BenchStep {
  std::string name;
  std::function<BenchRow()> run;
};

/// The median of several runs, each with a measurement of its ceiling beside it.
struct Timing {
  double seconds = 0, ceiling_rate = 0, of_ceiling = 0;
  int runs = 0;
};

/// Times `work`, which does `amount` units: once to learn its duration, then as often as the options allow.
/// @param ceiling  measures the highest possible units per second, anew around each run; may be empty
Timing time_work(const BenchOptions& options, const std::function<void()>& work, double amount,
                 const std::function<double()>& ceiling = {});

/// A row with the measured times.
BenchRow make_row(const std::string& stage, const std::string& job, const Timing& timing, double amount,
                  const std::string& unit, const std::string& ceiling = "");

/// A round number in short form: 1e4, 5e5.
std::string short_count(int64_t count);

// The steps of each group, in the order of the table.
std::vector<BenchStep> exact_steps(const BenchOptions& options);
std::vector<BenchStep> tiled_steps(const BenchOptions& options);
std::vector<BenchStep> planes_steps(const BenchOptions& options);
std::vector<BenchStep> layers_steps(const BenchOptions& options);
std::vector<BenchStep> triangles_steps(const BenchOptions& options);
std::vector<BenchStep> auto_steps(const BenchOptions& options);
std::vector<BenchStep> device_steps(const BenchOptions& options);
std::vector<BenchStep> trace_steps(const BenchOptions& options);
std::vector<BenchStep> render_steps(const BenchOptions& options);
std::vector<BenchStep> accelerators_steps(const BenchOptions& options);
std::vector<BenchStep> propagate_steps(const BenchOptions& options);
std::vector<BenchStep> show_steps(const BenchOptions& options);
std::vector<BenchStep> quality_steps(const BenchOptions& options);

/// Chart of the time of a ray against the number of triangles, from the rows of accelerators_steps.
Chart accelerators_chart(const std::vector<BenchRow>& rows);

}  // namespace holotrace
