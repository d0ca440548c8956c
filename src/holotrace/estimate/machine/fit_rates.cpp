#include "holotrace/estimate/machine/fit_rates.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "holotrace/base/error.h"

namespace holotrace {
namespace {

constexpr size_t terms = summation_terms.size();

// Row i, column k: fraction of run i that its work of kind k would take if one unit of it took seconds_if_all.
struct Parts {
  std::vector<std::array<double, terms>> of_run;
  std::array<double, terms> seconds_if_all{};  // least time over the runs that one unit could take [s]
};

Parts parts_of(const std::vector<TimedWork>& timed) {
  Parts parts;
  for (const TimedWork& run : timed) {
    require(run.seconds > 0, "expected a timed run of more than 0 s, got {} s", run.seconds);
    bool has_work = false;
    for (size_t k = 0; k < terms; ++k) {
      const double count = run.work.*summation_terms[k].count;
      if (count <= 0) continue;
      has_work = true;
      const double all = run.seconds / count;
      if (parts.seconds_if_all[k] == 0 || all < parts.seconds_if_all[k]) parts.seconds_if_all[k] = all;
    }
    require(has_work, "expected a timed run with some work, got one with none");
  }
  for (const TimedWork& run : timed) {
    auto& row = parts.of_run.emplace_back();
    for (size_t k = 0; k < terms; ++k)
      row[k] = run.work.*summation_terms[k].count * parts.seconds_if_all[k] / run.seconds;
  }
  return parts;
}

// Coordinate descent: sets each unknown in turn to its best value ≥ 0. The problem is convex, with few unknowns.
std::array<double, terms> least_squares(const Parts& parts) {
  std::array<double, terms> x{};
  for (int sweep = 0; sweep < 20000; ++sweep)
    for (size_t k = 0; k < terms; ++k) {
      double numerator = 0, denominator = 0;
      for (const auto& row : parts.of_run) {
        double rest = 1;
        for (size_t other = 0; other < terms; ++other)
          if (other != k) rest -= row[other] * x[other];
        numerator += row[k] * rest;
        denominator += row[k] * row[k];
      }
      if (denominator > 0) x[k] = std::max(0.0, numerator / denominator);
    }
  return x;
}

}  // namespace

SummationRates fit_rates(const std::vector<TimedWork>& timed) {
  const Parts parts = parts_of(timed);
  const std::array<double, terms> x = least_squares(parts);
  SummationRates rates;
  double faster = 0;
  int measured = 0;
  for (size_t k = 0; k < terms; ++k) {
    if (parts.seconds_if_all[k] == 0) continue;
    double& rate = rates.*summation_terms[k].rate;
    const double usual = rate;
    rate = 1 / (parts.seconds_if_all[k] * std::max(x[k], 0.01));
    if (usual <= 0) continue;
    faster += std::log(rate / usual);
    ++measured;
  }
  for (size_t k = 0; k < terms; ++k)
    if (parts.seconds_if_all[k] == 0 && measured > 0) rates.*summation_terms[k].rate *= std::exp(faster / measured);
  return rates;
}

}  // namespace holotrace
