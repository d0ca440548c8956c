#include "holotrace/estimate/machine/probes.h"

#include <algorithm>

namespace holotrace {

double refine_probes(std::vector<Probe>& probes, double share, double long_enough) {
  double spent = 0;
  const auto run = [&](Probe& probe) {
    probe.last = probe.run(probe.part);
    spent += probe.last.seconds;
  };
  for (Probe& probe : probes) run(probe);
  while (true) {
    double predicted = 0;
    for (const Probe& probe : probes) predicted += probe.last.predicted;
    Probe* next = nullptr;
    for (Probe& probe : probes) {
      const bool is_told = probe.part >= 1 || (!probe.last.is_forecast && probe.last.seconds >= long_enough);
      const double cost = probe.last.next > 0 ? probe.last.next : probe_growth * probe.last.seconds;
      const bool has_room = spent + cost <= share * predicted;
      if (!is_told && has_room && (!next || probe.last.predicted > next->last.predicted)) next = &probe;
    }
    if (!next) return spent;
    next->part = std::min(1.0, probe_growth * next->part);
    run(*next);
  }
}

double seconds_for(double times, double one, double two) { return one + (times - 1) * std::clamp(two - one, 0.0, one); }

}  // namespace holotrace
