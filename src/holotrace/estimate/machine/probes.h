#pragma once

#include <functional>
#include <string>
#include <vector>

namespace holotrace {

/// The result of one probe of a part of a task.
struct ProbeResult {
  double seconds = 0;        ///< time of the probe [s]
  double predicted = 0;      ///< predicted time of the whole task [s]
  double next = 0;           ///< expected time of the next probe [s]; 0: probe_growth times that of this one
  bool is_forecast = false;  ///< this probe ran no part of the task, so that the next one is as useful as a first
};

/// A task whose time is predicted from parts of it: each further probe runs a larger part and predicts better.
struct Probe {
  std::function<ProbeResult(double part)> run;  ///< runs a part in (0, 1]
  double part = 1;                              ///< part of the first probe; then of the last one
  ProbeResult last{};
};

/// Factor by which the part grows from one probe to the next.
constexpr double probe_growth = 4;

/// Probes all tasks once, then again in larger parts. The next one is always the task with the longest prediction for
/// which the budget has room. The budget is a share of the predicted time of all tasks; it improves with the probes.
///
/// A part grows fourfold, and its probe is expected to take four times as long, or `next` seconds if that is given. A
/// task is finished when it was probed whole or for `long_enough`.
///
/// @param share        fraction of the predicted time that all probes may take; the first ones are always run
/// @param long_enough  time of one probe that is enough [s]
/// @return             time of all probes [s]
double refine_probes(std::vector<Probe>& probes, double share, double long_enough);

/// Time of a stage for `times` as many holograms as in a run of one frame [s], from such a run and one of two frames
/// [s]: some of the work is done once, and each further hologram takes as long as the second frame added.
double seconds_for(double times, double one, double two);

}  // namespace holotrace
