#pragma once

#include <chrono>
#include <functional>
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

}  // namespace holotrace
