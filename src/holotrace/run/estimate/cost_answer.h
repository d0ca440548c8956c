#pragma once

#include <nlohmann/json_fwd.hpp>

#include "holotrace/data/job.h"
#include "holotrace/estimate/cost.h"
#include "holotrace/run/estimate/job_estimate.h"

namespace holotrace {

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
