#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/data/report.h"
#include "holotrace/estimate/cost.h"

namespace holotrace {

/// The predicted seconds of a stage of `run`.
struct StageEstimate {
  std::string stage;  ///< name as in reports
  double seconds = 0;
};

/// Predicted cost of a job, from short probes of its own stages on this machine (estimate/machine/probes.h). The probes
/// trace a part of the rays, render a part of the pixels, sum a part of the waves on a part of the panel, and run all
/// later stages on a smaller panel.
/// They grow while all of them together take a small share of the predicted time. A job of less than half a second
/// takes less time than the smallest probes.
struct JobEstimate {
  double wavelengths = 1, sets = 1, frames = 1;  ///< a run makes sets × frames holograms
  double lights = 0, subpixels = 1;              ///< samples per pixel, both axes together
  double paths = 0, rays = 0, shadow_rays = 0;   ///< totals of the tracing
  double mean_path_length = 0;                   ///< l_avg, surfaces on a path
  double prepare_seconds = 0;        ///< tracing: time that does not grow with the rays (acceleration structure)
  double seconds_per_ray = 0;        ///< T_t, all threads at work
  double other_seconds_per_ray = 0;  ///< T_t by the accelerator that the job does not ask for; 0: not measured
  std::string accelerator, other_accelerator;
  double triangles = 0;
  double grid_cells_per_ray = 0, grid_tests_per_ray = 0, grid_seconds_per_ray = 0;  ///< predicted, one thread
  double waves = 0, waves_pixels = 0;                                               ///< all sets, one frame
  std::string method;                                                               ///< method of the sum
  double probe_seconds = 0;                                                         ///< time of the estimate itself
  std::string why_no_other;           ///< why the other accelerator was not measured
  std::string why_no_simulation;      ///< why the stages beside tracing and the sum are missing
  std::vector<StageEstimate> stages;  ///< in the order of a run

  bool is_whole() const { return why_no_simulation.empty(); }  ///< whether it has all stages of a run
  double holograms() const { return sets * frames; }
  double seconds() const;
  double seconds_of(const std::string& prefix) const;  ///< stages whose names begin with `prefix`
};

/// @throws Error  as `run` does for the job; if the probe finds no light
JobEstimate estimate_job(const Job& given);

/// Adds T_t for the accelerator that the job does not use, and the predicted cost of the uniform grid. Takes seconds.
void measure_other_accelerator(const Job& job, JobEstimate& estimate);

/// Predicted and measured time of a stage.
struct StageComparison {
  std::string name;
  double predicted = 0, taken = 0;  ///< [s]

  /// Prediction over measurement, or none for a stage that took no time.
  std::optional<double> ratio() const { return taken > 0 ? std::optional(predicted / taken) : std::nullopt; }
};

/// Compares the predicted seconds of each stage with those of a run. A whole estimate also has entries "simulation",
/// all stages after the sum, and "all". Adds a stage "estimate" to the report with the facts "NAME predicted_seconds"
/// and "NAME ratio", prediction over measurement.
std::vector<StageComparison> compare_with_run(const JobEstimate& estimate, Report& report);

/// What a machine must do to show a job in real time: tracing, sums and encoding for every frame. Render, virtual
/// panel and camera are left out, because they only simulate the display.
struct RealTime {
  double frames_per_second = 0, seconds_per_frame = 0;
  double times = 0;                     ///< speed needed, relative to this machine
  double cores = 0;                     ///< cores needed, of this machine's kind
  double multiply_adds_per_second = 0;  ///< at the peak rate, in single precision
};

/// The predicted cost of a job, what real-time display needs, and the paper's count.
struct CostAnswer {
  JobEstimate estimate;
  RealTime real;
  Cost ours, per_pixel;  ///< Eq. 23 for the job's own paths, and for S paths per pixel
  double samples = 0;    ///< S
};

/// @param with_accelerators  also compare the time per ray of both accelerators; takes seconds
/// @throws Error  as estimate_job does
CostAnswer answer_about_cost(const Job& job, double frames_per_second, bool with_accelerators);

/// All figures by name, in SI units.
nlohmann::ordered_json cost_json(const CostAnswer& answer);

}  // namespace holotrace
