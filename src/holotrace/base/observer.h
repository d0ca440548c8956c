#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace holotrace {

/// A fact that a verb states about its work: a count, a figure, or a choice it made.
using Fact = std::variant<int64_t, double, std::string>;

/// Callbacks for what a caller wants to know while a verb works. The library never prints: it calls its observer. An
/// empty observer ignores everything.
struct Observer {
  std::function<void(double fraction)> on_progress;                         ///< called from any thread
  std::function<void(const std::string& name, const Fact& value)> on_fact;  ///< "method", "waves", …
  std::function<void(const std::string& sentence)> on_warning;              ///< a doubt about the result
  std::function<void(const std::string& name, const std::vector<double>& values)>
      on_curve{};  ///< a list of numbers: one per iteration, wavelength, view or eye
  std::function<void(const std::string& text)>
      on_status{};  ///< how far the result is, for a progress bar: "loss -28 dB"

  void progress(double fraction) const {
    if (on_progress) on_progress(fraction);
  }
  template <class Value>
  void fact(const std::string& name, const Value& value) const {
    if (!on_fact) return;
    if constexpr (std::is_integral_v<Value>)
      on_fact(name, int64_t(value));
    else
      on_fact(name, value);
  }
  void curve(const std::string& name, const std::vector<double>& values) const {
    if (on_curve) on_curve(name, values);
  }
  void status(const std::string& text) const {
    if (on_status) on_status(text);
  }
  void warn(const std::string& sentence) const {
    if (on_warning) on_warning(sentence);
  }
};

/// An observer for part `part` of `parts` equal parts of a task; `observer` receives the progress of the whole task.
inline Observer part_of(const Observer& observer, int part, int parts) {
  if (parts == 1 || !observer.on_progress) return observer;
  Observer of_part = observer;
  of_part.on_progress = [&observer, part, parts](double fraction) { observer.progress((part + fraction) / parts); };
  return of_part;
}

/// An observer for the part of a task from one fraction of its progress to another.
inline Observer part_between(const Observer& observer, double from, double to) {
  Observer part = observer;
  if (observer.on_progress)
    part.on_progress = [&observer, from, to](double fraction) { observer.progress(from + (to - from) * fraction); };
  return part;
}

/// An observer that ignores everything.
inline const Observer& nobody() {
  static const Observer observer;
  return observer;
}

/// Adds a fact of one part of a task to those of the parts before. Counts of waves, pixels, triangles and parts are summed, and so is
/// "predicted_seconds"; of "expected_error" the largest is kept; different methods are listed; of all others the first is kept.
void merge_fact(std::vector<std::pair<std::string, Fact>>& facts, const std::string& name, const Fact& value);

}  // namespace holotrace
