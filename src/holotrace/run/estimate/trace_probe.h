#pragma once

#include <map>
#include <string>

#include "holotrace/data/job.h"
#include "holotrace/estimate/machine/probes.h"
#include "holotrace/run/estimate/small_panel.h"
#include "holotrace/run/pipeline.h"

namespace holotrace {

/// Result of tracing a part of a job's rays: fewer rows and columns of the raster or, if triangles
/// are lit one by one, fewer light paths.
struct TraceProbe {
  explicit TraceProbe(const Job& job);

  ProbeResult run(double part);  ///< `part` is a fraction of the rays
  double first_part() const;     ///< small, but enough for all threads

  double ray_seconds() const { return std::max(0.0, predicted - prepare_seconds); }  ///< of all rays
  double count(const std::string& name) const;
  bool has_rays() const;  ///< whether the last probe shot any rays

  Job job;
  SceneLight light;                                    ///< of the last probe
  std::map<std::string, double> facts;                 ///< of the last probe
  double seconds = 0, prepare_seconds = 0, scale = 1;  ///< scale: number of all rays over that of the probe
  double predicted = 0;                                ///< seconds of the whole

 private:
  PartPredictions predictions_;
};

/// Number of first hits that a job looks for.
double first_rays(const Job& job);

/// The job with a part of its rays.
Job with_rays(Job job, double part);

/// T_t for the accelerator that the job does not use, on a raster that grows until it takes a tenth of a second; 0 if
/// no ray is shot.
double seconds_per_ray_by(Acceleration accelerator, const Job& job);

}  // namespace holotrace
