#pragma once

#include <functional>
#include <string>
#include <vector>

namespace holotrace {

/// What one probe of a part of some work has told.
struct ProbeResult {
  double seconds = 0;    ///< that the probe took
  double predicted = 0;  ///< of the whole work
  double next = 0;       ///< that the next probe should take, where this one ran no part of the work; else 0
};

/// A piece of work that is predicted from parts of itself: each further probe is of a larger part and tells more.
struct Probe {
  std::function<ProbeResult(double part)> run;  ///< of a part in (0, 1]
  double part = 1;                              ///< of the first probe; then of the last
  ProbeResult last{};
};

/// Each further probe is of a part as many times as large.
constexpr double probe_growth = 4;

/// Probes all works once, then again in larger parts, always the work that is predicted to take longest of those that
/// the budget still has room for: a share of what all are predicted to take, which the growing probes tell ever better.
///
/// A part grows fourfold, and a probe of it is expected to take four times as long, or what `next` says. A work is left alone when it was
/// probed whole or for `long_enough`.
///
/// @param share        of the predicted time that all probes together may take; the first ones are made in any case
/// @param long_enough  of one probe [s]
/// @return             seconds that the probes took
double refine_probes(std::vector<Probe>& probes, double share, double long_enough);

/// Seconds of a stage for `times` as many holograms as in a run of one frame, from such a run and one of two frames:
/// some of the work is done once for all, and each further hologram takes what the second frame took more.
double seconds_for(double times, double one, double two);

}  // namespace holotrace
