#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace holotrace {

/// Estimates the time left of a task from its progress: by the rate since the first reported fraction, which is above
/// 0 for a resumed task. The end is smoothed, so that the time left falls evenly although the rate varies.
class TimeLeft {
 public:
  /// @param seconds   time since the start [s], growing from call to call
  /// @param fraction  part of the task that is done, in [0, 1]
  /// @return          time left [s]; nothing until a fiftieth of the rest is done, and at the end
  std::optional<double> estimate(double seconds, double fraction) {
    if (!begun_ && fraction > 0) {
      begun_ = true;
      first_seconds_ = fraction > 0.02 ? seconds : 0;  // up to 2 % is progress of this run, not of an earlier one
      first_fraction_ = fraction > 0.02 ? fraction : 0;
    }
    const double done = fraction - first_fraction_;
    if (!begun_ || done < 0.02 * (1 - first_fraction_) || fraction >= 1) return std::nullopt;
    const double end = seconds + (seconds - first_seconds_) * (1 - fraction) / done;
    end_ = end_ ? *end_ + smoothing * (end - *end_) : end;
    return std::max(0.0, *end_ - seconds);
  }

 private:
  static constexpr double smoothing = 0.2;
  bool begun_ = false;
  double first_seconds_ = 0, first_fraction_ = 0;
  std::optional<double> end_;  ///< [s]
};

/// Text of a duration: "4.2 s", "3 min 05 s", "2 h 10 min".
inline std::string format_duration(double seconds) {
  if (seconds < 59.95) return fmt::format("{:.1f} s", seconds);
  const long whole = std::lround(seconds);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace holotrace
