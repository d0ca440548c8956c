#pragma once

#include <vector>

#include "holotrace/view/register/channel.h"

namespace holotrace {

/// One map from a picture to another, and how well they agree under it.
struct Match {
  Similarity map;    ///< from places of `fixed` to places of `moving`
  double score = 0;  ///< correlation coefficient times √(pixels in common)
};

/// The best shift for each of a set of angles around the whole circle. All shifts are compared at once by the
/// correlation coefficient over the overlap of the two pictures:
///
///     score(t) = Σ m(p + t)·f(p)/√(Σ m²(p + t)·Σ f²(p))·√n,   sums over the n places p inside both
///
/// Each sum is a correlation with a picture or its outline, computed by FFT (Padfield, IEEE Trans. Image
/// Process. 21, 2706 (2012)).
/// @param moving, fixed  pictures of one resolution, without shading
/// @param step           step between angles [rad]
/// @param least_overlap  fraction of the smaller picture that must overlap
std::vector<Match> coarse_search(const Channel& moving, const Channel& fixed, double step, double least_overlap);

}  // namespace holotrace
