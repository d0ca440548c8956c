#pragma once

#include <algorithm>
#include <iterator>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// The arguments of make_propagator. The device does not matter to it.
struct PropagationQuestion {
  Grid grid;
  double wavelength, distance;
  PropagateParams params;

  PropagationQuestion(const Grid& grid, double wavelength, double distance, const PropagateParams& given)
      : grid(grid), wavelength(wavelength), distance(distance), params(given) {
    params.device = {};
  }
  bool operator==(const PropagationQuestion&) const = default;
};

/// A propagator, with the facts and warnings of its making, which are told whenever it is used.
template <class Propagator>
struct KeptPropagator {
  std::shared_ptr<Propagator> propagator{};
  std::vector<std::pair<std::string, Fact>> facts{};
  std::vector<std::string> warnings{};

  /// Collects facts and warnings. It must not outlive this object.
  Observer listener() {
    Observer notes;
    notes.on_fact = [this](const std::string& name, const Fact& value) { facts.emplace_back(name, value); };
    notes.on_warning = [this](const std::string& sentence) { warnings.push_back(sentence); };
    return notes;
  }
  void tell(const Observer& observer) const {
    for (const auto& [name, value] : facts)
      if (observer.on_fact) observer.on_fact(name, value);
    for (const std::string& warning : warnings) observer.warn(warning);
  }
};

/// Propagators by the questions that they answer. Those that were asked for once may be held to a part of the memory: most jobs
/// have many distances and use each once. What was asked for again may take all of it, and is known again even if it was
/// dropped in between (2Q; Johnson and Shasha 1994). May be used from any thread. Those that are dropped are destroyed
/// after the lock is released, because that may wait for a device.
template <class Propagator>
class KeptPropagators {
 public:
  using Kept = KeptPropagator<Propagator>;

  /// @param part_of_once  of the limit, for those that were asked for once
  explicit KeptPropagators(double part_of_once = 1) : part_of_once_(part_of_once) {}

  std::optional<Kept> find(const PropagationQuestion& question) {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.question == question; });
    if (found == entries_.end()) return std::nullopt;
    found->is_asked_again = true;
    entries_.splice(entries_.begin(), entries_, found);
    return found->kept;
  }

  /// Keeps a propagator of `bytes`, and drops the least recently used ones beyond `limit`. A larger one is not kept.
  void keep(const PropagationQuestion& question, const Kept& kept, double bytes, double limit) {
    if (bytes > limit) return;
    {
      const std::lock_guard lock(mutex_);
      const auto has = [&](const Entry& entry) { return entry.question == question; };
      if (std::ranges::any_of(entries_, has)) return;  // another thread has made it meanwhile
      const auto known = std::find(asked_.begin(), asked_.end(), question);
      entries_.push_front({question, kept, bytes, known != asked_.end()});
      if (known != asked_.end())
        asked_.splice(asked_.begin(), asked_, known);
      else
        asked_.push_front(question);
      constexpr size_t most_questions = 256;
      if (asked_.size() > most_questions) asked_.pop_back();
    }
    drop_beyond(limit);
  }

  /// Memory of all of them [bytes].
  double bytes() {
    const std::lock_guard lock(mutex_);
    double all = 0;
    for (const Entry& entry : entries_) all += entry.bytes;
    return all;
  }

  /// Keeps the most recently used ones that fit in `limit` [bytes] together, and drops the others.
  void drop_beyond(double limit) {
    std::list<Entry> dropped;
    const std::lock_guard lock(mutex_);
    double bytes = 0, of_once = 0;
    for (auto entry = entries_.begin(); entry != entries_.end();) {
      const auto next = std::next(entry);
      const double once = entry->is_asked_again ? 0 : entry->bytes;
      if (bytes + entry->bytes > limit || (once > 0 && of_once + once > part_of_once_ * limit)) {
        dropped.splice(dropped.end(), entries_, entry);
      } else {
        bytes += entry->bytes;
        of_once += once;
      }
      entry = next;
    }
  }

 private:
  struct Entry {
    PropagationQuestion question;
    Kept kept;
    double bytes;
    bool is_asked_again;
  };
  const double part_of_once_;
  std::mutex mutex_;
  std::list<Entry> entries_;              // most recently used first
  std::list<PropagationQuestion> asked_;  // lately, also for those that were dropped
};

/// The propagator that make_propagator makes of the same arguments, kept for reuse: the frames of a job share one for
/// each wavelength and distance. Facts and warnings are reported on every call. May be called from any thread.
///
/// Keeps the most recently used ones, up to propagator_cache_bytes for each precision (KeptPropagators). A larger one is not
/// kept.
/// @throws Error  as make_propagator does
template <class Real>
std::shared_ptr<const Propagator<Real>> cached_propagator(const Grid& grid, double wavelength, double distance,
                                                          const PropagateParams& params, const Observer& observer = {});

/// Limit of the transfer functions kept for each precision [bytes]: 512 MiB, or a sixteenth of the memory, unless
/// limit_propagator_cache was called.
double propagator_cache_bytes();

/// Lowers that limit, for programs that use each distance once.
void limit_propagator_cache(double bytes);

}  // namespace holotrace
