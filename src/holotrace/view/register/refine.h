#pragma once

#include "holotrace/view/register/channel.h"

namespace holotrace {

/// How two pictures fit, once laid upon each other as well as they can be.
struct Fit {
  Similarity map;          ///< places of `fixed` to those of `moving`
  double correlation = 0;  ///< coefficient over what they have in common
  double pixels = 0;       ///< of `fixed` in common
  double uncertainty = 0;  ///< standard error of a place at the worst corner of `fixed` [pixels of moving]
  int iterations = 0;
  double score() const;  ///< correlation·√pixels
};

/// Lays `moving` upon `fixed`: finds the similarity W of
///
///     Σ (f·∇m − m·∇f)·Xₖ = 0,   k = 1 … 4
///
/// over the places p that W takes into `moving`; m = moving(W(p)), f = fixed(p), both slopes along the axes of
/// `moving`, and Xₖ how the places move with a, b, x and y. It holds where m is a multiple of f. Unlike the least
/// squares of m − g·f, the sums have no product of a picture's noise with itself, whose share at the edges outweighs
/// that of the picture in strong speckle. The derivative, −2·Σ (∇m·Xₖ)(∇f·Xₗ) where they fit, gives Newton's step.
/// The standard error is White's, summed over blocks of 16 × 16 pixels as by Liang and Zeger, Biometrika 73, 13 (1986):
/// it holds for noise that goes with the light, as speckle does, and that has a grain smaller than a block.
/// @param moving, fixed  of about one resolution, without shading
/// @param start          within about the size of their structure of the truth
/// @return               pixels = 0 where they come to have nothing in common or no structure decides
Fit refine(const Channel& moving, const Channel& fixed, const Similarity& start, int most_iterations);

}  // namespace holotrace
