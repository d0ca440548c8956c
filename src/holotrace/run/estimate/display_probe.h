#pragma once

#include <string>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/data/report.h"
#include "holotrace/estimate/machine/probes.h"

namespace holotrace {

/// The job at a smaller scale: a panel of `side` times the columns and rows, with the same pixels. All lengths of
/// the camera, of targets and of the light are reduced by the same factor. Transforms, windows and their sampling
/// conditions are the job's at that size. It has as many illumination states as the job if a spectrum needs them.
/// Its scene is one luminous point, which lights all of the panel.
Job on_small_panel(const Job& job, double side);

/// Predicts the stages after the sum from a run of the small job: one frame and, if there are more
/// holograms, also two, which separates the cost per run from the cost per hologram. Iterative encoders run a few
/// iterations, and light of many illumination states is probed at two and at four of them. The times are scaled by
/// pixels, times the logarithm for transforms; those of iterations by the times of a propagation from both panels.
struct DisplayProbe {
  explicit DisplayProbe(const Job& job) : job(job) {}

  /// `part` is a fraction of the panel's pixels. If the job cannot run on it, four times as many are tried once.
  ProbeResult run(double part);
  double predict(double part);  ///< seconds of all stages; sets `stages`; throws Error if the job cannot be run
  double first_part() const;

  Job job;
  double holograms = 1;             ///< number in the whole job
  std::vector<StageReport> stages;  ///< stages after the sum with predicted seconds, named as the job's
  std::string why_none;             ///< why they cannot be run, if they cannot

 private:
  int tried_iterations(double part) const;
  double iteration_scale(const Job& small);

  double encode_seconds_ = 0;       // of all runs of the last probe, if the encoder iterates
  double once_seconds_ = 0;         // of the last probe, that the next one does not take again
  double propagation_seconds_ = 0;  // of the job's panel
  double part_ = 0;                 // part of the last probe that could be run
  std::vector<double> of_part_;     // and its own prediction for each stage
};

}  // namespace holotrace
