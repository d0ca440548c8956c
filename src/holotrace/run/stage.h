#pragma once

#include <fmt/format.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>

#include "holotrace/data/report.h"

namespace holotrace {

/// Makes the observer of a stage that is about to run, from its name. This is where a caller shows progress.
using StageObserver = std::function<Observer(const std::string& stage)>;

/// Runs `stage(observer)`, adds its time, facts, curves and warnings to the report, and returns its result.
template <class Stage>
auto run_stage(const std::string& name, Report& report, const StageObserver& watch, const Stage& stage) {
  const Observer caller = watch ? watch(name) : Observer{};
  StageReport entry{name, 0, {}, {}, {}};
  const Observer recorder{caller.on_progress,
                          [&](const std::string& key, const Fact& value) {
                            entry.facts.emplace_back(key, value);
                            caller.fact(key, value);
                          },
                          [&](const std::string& sentence) {
                            entry.warnings.push_back(sentence);
                            caller.warn(sentence);
                          },
                          [&](const std::string& key, const std::vector<double>& values) {
                            entry.curves.emplace_back(key, values);
                            caller.curve(key, values);
                          },
                          caller.on_status};
  const auto start = std::chrono::steady_clock::now();
  auto result = stage(recorder);
  entry.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report.stages.push_back(std::move(entry));
  return result;
}

/// The stages that every hologram of a run passes, at every illumination state of its light. With one hologram and one
/// state they are ordinary stages. With more, a caller sees one stage "N holograms" (or "N illumination states") with
/// the progress of all. It hears each warning once, also where holograms or colours differ in its numbers. The report has one
/// entry per name: the total seconds, the facts of all (merge_fact), the curves of the first, and each warning once.
class RepeatedStages {
 public:
  /// @param holograms  number of holograms
  /// @param states     number of illumination states of each
  /// @param calls      number of calls that will be made, for progress
  RepeatedStages(int64_t holograms, int64_t states, int64_t calls, Report& report, const StageObserver& watch)
      : holograms_(holograms), states_(states), calls_(calls), report_(report), watch_(watch) {
    if (!is_repeated() || !watch) return;
    caller_ =
        watch(holograms > 1 ? fmt::format("{} holograms", holograms) : fmt::format("{} illumination states", states));
  }

  /// Runs `work(observer)` as a stage of that name and returns its result.
  template <class Work>
  auto operator()(const std::string& name, const Work& work) {
    Report once;
    auto result = run_stage(
        name, once, [&](const std::string&) { return observer_of(name); }, work);
    merge(std::move(once.stages.front()));
    ++done_;
    return result;
  }

  /// Whether a stage of that name has run.
  bool has_run(const std::string& name) const;

  /// Runs `work(observer)` as the end of a stage that has run. Its facts, curves, warnings and seconds are added to the
  /// stage's entry. The caller hears of its warnings only.
  template <class Work>
  void finish(const std::string& name, const Work& work) {
    Report once;
    Observer warned;
    warned.on_warning = [&](const std::string& sentence) { observer_of(name).warn(sentence); };
    run_stage(
        name, once, [&](const std::string&) { return warned; },
        [&](const Observer& o) {
          work(o);
          return true;
        });
    merge(std::move(once.stages.front()));
  }

 private:
  Observer observer_of(const std::string& name) {
    if (!is_repeated()) return watch_ ? watch_(name) : Observer{};
    Observer observer;
    observer.on_progress = [this](double fraction) { caller_.progress((double(done_) + fraction) / double(calls_)); };
    observer.on_warning = [this, name](const std::string& sentence) {
      if (told_.insert(without_numbers(sentence)).second) caller_.warn(name + ": " + sentence);
    };
    return observer;
  }

  static std::string without_numbers(std::string sentence) {
    std::erase_if(sentence, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
    return sentence;
  }

  bool is_repeated() const { return holograms_ * states_ > 1; }
  void merge(StageReport&& once);

  int64_t holograms_, states_, calls_, done_ = 0;
  Report& report_;
  const StageObserver& watch_;
  Observer caller_;
  std::set<std::string> told_;
};

}  // namespace holotrace
