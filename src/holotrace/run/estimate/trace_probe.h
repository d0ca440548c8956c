#pragma once

#include <map>
#include <string>

#include "holotrace/data/job.h"
#include "holotrace/estimate/machine/probes.h"
#include "holotrace/run/pipeline.h"

namespace holotrace {

/// What the tracing of a part of a job's rays has told: by rows and columns of the raster alike, or, where triangles
/// are lit one by one, by their light paths.
struct TraceProbe {
  explicit TraceProbe(const Job& job);

  ProbeResult run(double part);  ///< of the rays
  double first_part() const;     ///< small, but enough for all threads

  double ray_seconds() const { return std::max(0.0, seconds - prepare_seconds) * scale; }
  double count(const std::string& name) const;
  bool has_rays() const;  ///< whether the last probe shot any

  Job job;
  SceneLight light;                                    ///< of the last probe
  std::map<std::string, double> facts;                 ///< of the last probe
  double seconds = 0, prepare_seconds = 0, scale = 1;  ///< scale: of all rays over those of the probe
};

/// The first hits that a job looks for.
double first_rays(const Job& job);

/// The job with a part of its rays.
Job with_rays(Job job, double part);

/// T_t by the other accelerator than the job's own, on a raster that grows until it takes a tenth of a second; 0 where
/// no ray is shot.
double seconds_per_ray_by(Acceleration accelerator, const Job& job);

}  // namespace holotrace
