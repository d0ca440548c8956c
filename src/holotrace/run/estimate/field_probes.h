#pragma once

#include <map>
#include <string>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/data/sources.h"
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

/// A set with another number of waves: each is repeated next to itself, within `spacing` times its depth,
/// except for the first `fixed` waves (luminous points, whose number does not grow with the raster).
/// @param factor  ≥ 1
Sources grow(const Sources& sources, size_t fixed, double factor, double spacing);

/// A part of the waves, chosen evenly.
Sources take_part(const Sources& sources, double part);

/// The waves with all coordinates times `side`, which a smaller panel (`side` times the columns and rows) sees at the
/// same angles.
Sources in_the_small(Sources sources, double side);

/// Predicts the time for summing the waves of one frame.
///
/// First, the cost model with the rates of this machine forecasts the sum of all waves. Further probes correct
/// it: a part of the waves is summed on the middle of the panel, and the forecast is scaled by the ratio of the
/// measured time to the forecast of that part. Slices are propagated to a smaller panel, from a part of the waves at
/// nearer places, and scaled by their number and by the panel's transforms. The exact sum scales by waves times pixels.
struct SynthesisProbe {
  /// @param sets  the waves of the whole job
  SynthesisProbe(const Job& job, std::vector<Sources> sets);

  ProbeResult run(double part);  ///< `part` is a fraction of waves times pixels
  double first_part() const;

  Job job;
  std::vector<Sources> sets;
  double waves = 0, waves_pixels = 0;
  double forecast = 0, planning = 0;  ///< seconds of the whole by the cost model, and for planning
  std::vector<double> slices;         ///< number of slices of each set, 0 for methods without slices
  std::string method;
  bool is_forecast_told = false;

 private:
  ProbeResult run_slices(const Sources& set, double part);

  PartPrediction of_slices_;  // of the last probe
};

}  // namespace holotrace
