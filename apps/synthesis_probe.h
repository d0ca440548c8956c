#pragma once

#include <string>

#include "holotrace/data/grid.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// The waves of a set grown to another number: each is repeated beside itself, within `spacing` of its depth across,
/// the first `fixed` (luminous points, which do not grow with the raster) excepted.
/// @param factor  ≥ 1
Sources grow(const Sources& sources, size_t fixed, double factor, double spacing);

/// What summing waves should take.
struct SynthesisEstimate {
  double seconds = 0;
  std::string method;
};

/// The cost model's forecast for all of the waves, by what a part of them takes now against the forecast for that part;
/// or, if that is not above some 0.5 s, the sum itself. Ways of summing that the model does not know are timed on two
/// parts and extended along the straight line through both.
SynthesisEstimate estimate_synthesis(const Sources& sources, const Grid& panel, const SynthesizeParams& params);

}  // namespace holotrace
