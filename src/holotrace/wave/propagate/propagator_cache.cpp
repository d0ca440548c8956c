#include "holotrace/wave/propagate/propagator_cache.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <list>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/memory.h"

namespace holotrace {
namespace {

// The arguments of make_propagator.
struct Question {
  Grid grid;
  double wavelength, distance;
  PropagateParams params;
  bool operator==(const Question&) const = default;
};

// The propagator that it made, with its facts and warnings.
template <class Real>
struct Entry {
  Question question;
  std::shared_ptr<const Propagator<Real>> propagator;
  std::vector<std::pair<std::string, Fact>> facts;
  std::vector<std::string> warnings;
};

template <class Real>
struct Cache {
  std::mutex mutex;
  std::list<Entry<Real>> entries;  // most recently used first
};

template <class Real>
Cache<Real>& cache() {
  static auto& kept = *new Cache<Real>;  // never destroyed: threads may propagate until the program ends
  return kept;
}

template <class Real>
Entry<Real> make_entry(const Question& question) {
  Entry<Real> entry{question, nullptr, {}, {}};
  Observer notes;
  notes.on_fact = [&](const std::string& name, const Fact& value) { entry.facts.emplace_back(name, value); };
  notes.on_warning = [&](const std::string& sentence) { entry.warnings.push_back(sentence); };
  entry.propagator = std::make_shared<const Propagator<Real>>(
      make_propagator<Real>(question.grid, question.wavelength, question.distance, question.params, notes));
  return entry;
}

std::atomic<double> given_limit = std::numeric_limits<double>::infinity();

template <class Real>
void keep(Entry<Real> entry) {
  Cache<Real>& kept = cache<Real>();
  const std::lock_guard lock(kept.mutex);
  double bytes = entry.propagator->bytes();
  if (bytes > propagator_cache_bytes()) return;
  kept.entries.push_front(std::move(entry));
  for (auto at = std::next(kept.entries.begin()); at != kept.entries.end(); ++at) {
    bytes += at->propagator->bytes();
    if (bytes <= propagator_cache_bytes()) continue;
    kept.entries.erase(at, kept.entries.end());
    break;
  }
}

template <class Real>
void tell(const Entry<Real>& entry, const Observer& observer) {
  for (const auto& [name, value] : entry.facts)
    if (observer.on_fact) observer.on_fact(name, value);
  for (const std::string& warning : entry.warnings) observer.warn(warning);
}

}  // namespace

double propagator_cache_bytes() { return std::min({512.0 * 1024 * 1024, physical_memory() / 16, given_limit.load()}); }

void limit_propagator_cache(double bytes) { given_limit = bytes; }

template <class Real>
std::shared_ptr<const Propagator<Real>> cached_propagator(const Grid& grid, double wavelength, double distance,
                                                          const PropagateParams& params, const Observer& observer) {
  const Question question{grid, wavelength, distance, params};
  {
    Cache<Real>& kept = cache<Real>();
    const std::lock_guard lock(kept.mutex);
    const auto found = std::find_if(kept.entries.begin(), kept.entries.end(),
                                    [&](const Entry<Real>& entry) { return entry.question == question; });
    if (found != kept.entries.end()) {
      kept.entries.splice(kept.entries.begin(), kept.entries, found);
      tell(*found, observer);
      return found->propagator;
    }
  }
  Entry<Real> entry = make_entry<Real>(question);
  tell(entry, observer);
  const auto propagator = entry.propagator;
  keep(std::move(entry));
  return propagator;
}

template std::shared_ptr<const Propagator<float>> cached_propagator(const Grid&, double, double, const PropagateParams&,
                                                                    const Observer&);
template std::shared_ptr<const Propagator<double>> cached_propagator(const Grid&, double, double,
                                                                     const PropagateParams&, const Observer&);

}  // namespace holotrace
