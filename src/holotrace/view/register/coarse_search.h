#pragma once

#include <vector>

#include "holotrace/view/register/channel.h"

namespace holotrace {

/// One way to lay a picture upon another, and how well it does.
struct Match {
  Similarity map;    ///< places of `fixed` to those of `moving`
  double score = 0;  ///< correlation coefficient times √(pixels in common)
};

/// The best shift for each of a set of angles about the whole circle, by the correlation coefficient of what the two
/// have in common, over all shifts at once:
///
///     score(t) = Σ m(p + t)·f(p)/√(Σ m²(p + t)·Σ f²(p))·√n,   sums over the n places p where both are
///
/// each of the sums being a correlation with a picture or its outline, done by FFT (Padfield, IEEE Trans. Image
/// Process. 21, 2706 (2012)).
/// @param moving, fixed  of one resolution, without shading
/// @param step           between angles [rad]
/// @param least_overlap  part of the smaller picture that must be in common
std::vector<Match> coarse_search(const Channel& moving, const Channel& fixed, double step, double least_overlap);

}  // namespace holotrace
