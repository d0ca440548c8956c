#pragma once

#include <string>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/data/report.h"

namespace holotrace {

/// The seconds that a stage of `run` should take.
struct StageEstimate {
  std::string stage;  ///< as reports name it
  double seconds = 0;
};

/// What a job should cost, from short probes of its own stages on this machine (estimate/machine/probes.h): a part of the rays,
/// of the render's pixels, of the waves and the panel that they are summed on, and all that follows on a smaller panel.
/// Parts grow as long as all probes together take a small share of what they predict. A job of less than half a second
/// is over sooner than the smallest probes.
struct JobEstimate {
  double wavelengths = 1, sets = 1, frames = 1;  ///< a run makes sets × frames holograms
  double lights = 0, subpixels = 1;              ///< of a pixel, both axes together
  double paths = 0, rays = 0, shadow_rays = 0;   ///< of the whole tracing
  double mean_path_length = 0;                   ///< l_avg, surfaces on a path
  double prepare_seconds = 0;        ///< of tracing: what does not grow with the rays, the acceleration structure
  double seconds_per_ray = 0;        ///< T_t, all threads at work
  double other_seconds_per_ray = 0;  ///< T_t by the accelerator that the job does not ask for; 0: not measured
  std::string accelerator, other_accelerator;
  double triangles = 0;
  double grid_cells_per_ray = 0, grid_tests_per_ray = 0, grid_seconds_per_ray = 0;  ///< predicted, one thread
  double waves = 0, waves_pixels = 0;                                               ///< of all sets, one frame
  std::string method;                                                               ///< of the sum
  double probe_seconds = 0;                                                         ///< of the estimate itself
  std::string why_no_other;           ///< why the other accelerator was not measured
  std::string why_no_simulation;      ///< why the stages beside tracing and the sum are missing
  std::vector<StageEstimate> stages;  ///< in the order of a run

  bool is_whole() const { return why_no_simulation.empty(); }  ///< has all stages of a run
  double holograms() const { return sets * frames; }
  double seconds() const;
  double seconds_of(const std::string& prefix) const;  ///< of the stages whose names begin so
};

/// @throws Error  as `run` does on the job; if the probe finds no light
JobEstimate estimate_job(const Job& job);

/// Adds T_t by the accelerator that the job does not ask for, and what the uniform grid should cost. Takes seconds.
void measure_other_accelerator(const Job& job, JobEstimate& estimate);

/// What was predicted for a stage, and what it took.
struct StageComparison {
  std::string name;
  double predicted = 0, taken = 0;  ///< [s]
};

/// Seconds of each stage beside those that a run took, then, of a whole estimate, of "simulation", all stages after the
/// sum, and of "all". Adds them to the report as a stage "estimate": the facts "NAME predicted_seconds" and "NAME
/// ratio", prediction over outcome.
std::vector<StageComparison> compare_with_run(const JobEstimate& estimate, Report& report);

}  // namespace holotrace
