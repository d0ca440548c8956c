#pragma once

#include "holotrace/data/image.h"

namespace holotrace {

/// Relative L2 noise of a picture a, from another one, b, of the same light with independent noise of the same size:
///
///     √( Σ(a − b)²/2 / Σ((a + b)/2)² )        the variance of a difference is twice that of each
///
/// @throws Error  for pictures of different sizes, and for dark ones
double picture_noise(const Image& a, const Image& b);

}  // namespace holotrace
