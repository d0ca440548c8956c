#pragma once

#include <string>
#include <vector>

#include "holotrace/data/job.h"
#include "holotrace/data/sources.h"
#include "holotrace/estimate/machine/probes.h"
#include "holotrace/run/estimate/small_panel.h"

namespace holotrace {

/// The waves of a set grown to another number: each is repeated beside itself, within `spacing` of its depth across,
/// the first `fixed` (luminous points, which do not grow with the raster) excepted.
/// @param factor  ≥ 1
Sources grow(const Sources& sources, size_t fixed, double factor, double spacing);

/// A part of the waves, evenly over all.
Sources take_part(const Sources& sources, double part);

/// The waves at `side` times their places: what a panel of as much fewer columns and rows meets at the same angles.
Sources in_the_small(Sources sources, double side);

/// What summing the waves of one frame should take.
///
/// The cost model, by the rates of this machine, forecasts the sum of all waves: the first answer. Further ones correct
/// it: a part of the waves is summed on the middle of the panel, and what that takes over its own forecast is what the
/// machine makes of the model now. Slices are carried to a smaller panel, from a part of the waves at places as much
/// nearer, and go by their number and by what transforms of the panel take. The exact sum goes by waves times pixels.
struct SynthesisProbe {
  /// @param sets  the waves of the whole job
  SynthesisProbe(const Job& job, std::vector<Sources> sets);

  ProbeResult run(double part);  ///< of the waves times pixels
  double first_part() const;

  Job job;
  std::vector<Sources> sets;
  double waves = 0, waves_pixels = 0;
  double forecast = 0, planning = 0;  ///< seconds of the whole, by the cost model and of making its plan
  std::vector<double> slices;         ///< of each set, where its waves are put into slices; else 0
  std::string method;
  bool is_forecast_told = false;

 private:
  ProbeResult run_slices(const Sources& set, double part);

  PartPrediction of_slices_;  // of the last probe
};

}  // namespace holotrace
