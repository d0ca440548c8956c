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

/// Result of fitting one picture to another.
struct Fit {
  Similarity map;          ///< from places of `fixed` to places of `moving`
  double correlation = 0;  ///< correlation coefficient over the overlap
  double pixels = 0;       ///< pixels of `fixed` in the overlap
  double uncertainty = 0;  ///< standard error of a place at the worst corner of `fixed` [pixels of moving]
  int iterations = 0;
  double score() const;  ///< correlation·√pixels
};

/// Fits `moving` to `fixed`: finds the similarity W that solves
///
///     Σ (f·∇m − m·∇f)·Xₖ = 0,   k = 1 … 4
///
/// The sum is over the places p that W maps into `moving`; m = moving(W(p)), f = fixed(p), both slopes are along the
/// axes of `moving`, and Xₖ is the derivative of the place by a, b, x and y. It holds if m is a multiple of f. Unlike
/// least squares of m − g·f, the sums have no product of a picture's noise with itself, which in strong speckle would
/// outweigh the picture at its edges. The derivative, −2·Σ (∇m·Xₖ)(∇f·Xₗ) at the solution, gives Newton's step.
/// The standard error is White's, summed over blocks of 16 × 16 pixels as by Liang and Zeger, Biometrika 73, 13 (1986).
/// It holds for noise proportional to the light, such as speckle, with grains smaller than a block.
/// @param moving, fixed  pictures of about one resolution, without shading
/// @param start          a map whose error is at most about the size of the pictures' structure
/// @return               the fit; pixels = 0 if the pictures have no overlap or too little structure
Fit refine(const Channel& moving, const Channel& fixed, const Similarity& start, int most_iterations);

}  // namespace holotrace
