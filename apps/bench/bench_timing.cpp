#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/bench.h"
#include "holotrace/estimate/machine/timing.h"

namespace holotrace {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::nth_element(values.begin(), values.begin() + long(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

Timing time_work(const BenchOptions& options, const std::function<void()>& work, double amount,
                 const std::function<double()>& ceiling) {
  std::vector<double> seconds, ceilings, parts;
  double before = ceiling ? ceiling() : 0;
  const auto run = [&] {
    const double taken = median_seconds(1, work);
    seconds.push_back(taken);
    if (!ceiling) return;
    const double after = ceiling();
    ceilings.push_back((before + after) / 2);
    parts.push_back(amount / taken / ceilings.back());
    before = after;
  };
  run();
  // The first run also makes what later runs reuse: it counts only if there is no time for others.
  const int at_least = seconds[0] < 3 ? 1 : 0;
  const int more = std::clamp(int(options.seconds_per_row / seconds[0]), at_least, 7);
  if (more > 0) {
    seconds.clear();
    ceilings.clear();
    parts.clear();
  }
  for (int i = 0; i < more; ++i) run();
  return {median(seconds), median(ceilings), median(parts), int(seconds.size())};
}

BenchRow make_row(const std::string& stage, const std::string& job, const Timing& timing, double amount,
                  const std::string& unit, const std::string& ceiling) {
  return {.stage = stage,
          .job = job,
          .seconds = timing.seconds,
          .runs = timing.runs,
          .rate = amount / timing.seconds,
          .unit = unit,
          .ceiling_rate = timing.ceiling_rate,
          .ceiling = ceiling,
          .of_ceiling = timing.of_ceiling};
}

std::string short_count(int64_t count) {
  const int power = count > 0 ? int(std::log10(double(count)) + 1e-9) : 0;
  const double leading = double(count) / std::pow(10, power);
  if (power < 3 || leading != std::round(leading)) return fmt::to_string(count);
  return fmt::format("{:.0f}e{}", leading, power);
}

}  // namespace holotrace
