#pragma once

#include <string>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/data/report.h"
#include "holotrace/estimate/machine/probes.h"

namespace holotrace {

/// The job in the small: a panel of `side` times the columns and rows, of the same pixels, before which all lengths of
/// the camera, of targets and of the light are as much shorter. Transforms, windows and their sampling conditions are
/// the job's own at that size, and it has as many illumination states as the job where a spectrum needs them. Its scene is one luminous point, which lights all of the panel.
Job on_small_panel(const Job& job, double side);

/// What the stages after the sum should take, from a run of the job in the small: one frame; where there are more
/// holograms two, too, which tells what is done once from what every hologram takes; encoders that iterate for a few
/// iterations; and light of many illumination states at two and at four of them. Scaled by pixels, and with them the logarithm that transforms have.
struct DisplayProbe {
  explicit DisplayProbe(const Job& job) : job(job) {}

  /// Of the panel's pixels. A panel on which the job cannot be run is followed by one of four times as many, once.
  ProbeResult run(double part);
  double predict(double part);  ///< seconds of all stages; sets `stages`; throws Error where the job cannot be run
  double first_part() const;

  Job job;
  double holograms = 1;             ///< of the whole job
  std::vector<StageReport> stages;  ///< after the sum, with the seconds that they should take, named as the job's
  std::string why_none;             ///< why they cannot be run, if so

 private:
  double part_ = 0;              // of the last probe that could be run
  std::vector<double> of_part_;  // and what it alone predicted for each stage
};

}  // namespace holotrace
