#include "holotrace/wave/shared/cost_model.h"

#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"

namespace holotrace {
namespace {

// The rates belong to the machine and not to the caller: one instance for the whole program.
struct Machine {
  std::recursive_mutex mutex;  // recursive: a measurement may itself sum waves and ask for the rates
  std::function<SummationRates()> measure;
  std::optional<SummationRates> rates;
};

Machine& machine() {
  static Machine the_machine;
  return the_machine;
}

}  // namespace

double predict_seconds(const SummationWork& work, const SummationRates& rates, int threads) {
  require(threads >= 1, "expected at least one thread, got {}", threads);
  double seconds = 0;
  for (const SummationTerm& term : summation_terms) {
    const double count = work.*term.count, rate = rates.*term.rate;
    if (count <= 0) continue;
    if (!(rate > 0)) return std::numeric_limits<double>::infinity();
    seconds += count / (rate * threads);
  }
  return seconds;
}

double fft_operations(double samples) { return samples > 1 ? 5 * samples * std::log2(samples) : 0; }

void set_summation_rates(std::function<SummationRates()> measure) {
  const std::lock_guard lock(machine().mutex);
  machine().measure = std::move(measure);
  machine().rates.reset();
}

SummationRates summation_rates() {
  const std::lock_guard lock(machine().mutex);
  if (!machine().rates) {
    machine().rates = SummationRates();
    if (machine().measure) machine().rates = machine().measure();
  }
  return *machine().rates;
}

double processor_seconds(const SummationWork& work) {
  return predict_seconds(work, summation_rates(), processor_threads());
}

}  // namespace holotrace
