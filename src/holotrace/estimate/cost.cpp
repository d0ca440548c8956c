#include "holotrace/estimate/cost.h"

#include <cmath>

#include "holotrace/base/error.h"

namespace holotrace {

double mean_path_length(double reflectance, int bounces) {
  require(reflectance >= 0 && reflectance < 1,
          "expected a probability in [0, 1) that a path goes on, got {}; at 1 no path would end", reflectance);
  if (bounces < 0) return 1 / (1 - reflectance);
  return (1 - std::pow(reflectance, bounces + 1)) / (1 - reflectance);
}

Cost estimate_cost(const CostInputs& in) {
  for (double value : {in.pixels, in.samples_per_pixel, in.frames, in.trace_seconds, in.waves, in.wave_rate})
    require(std::isfinite(value) && value >= 0, "expected counts and times of 0 or more, got {}", value);
  require(in.wave_rate > 0, "expected a rate above 0 waves·pixels/s, got {}", in.wave_rate);
  Cost cost;
  cost.paths = in.pixels * in.samples_per_pixel;
  cost.mean_path_length = mean_path_length(in.reflectance);
  cost.rays = cost.mean_path_length * cost.paths;
  cost.trace_seconds = in.frames * cost.paths * (1 + cost.mean_path_length) * in.trace_seconds;
  cost.synthesis_seconds = in.frames * in.waves * in.pixels / in.wave_rate;
  cost.seconds = cost.trace_seconds + cost.synthesis_seconds;
  return cost;
}

}  // namespace holotrace
