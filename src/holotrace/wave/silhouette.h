#pragma once

#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/wave/spread.h"

namespace holotrace {

/// What the points of a slice hide: each a disc that reaches to its fourth-nearest neighbour on the slice over √2
/// (a square lattice of points is just covered, and 84 % of a random scatter), at most three times the slice's
/// median and at least half a sample; a lone point hides its own sample.
///
/// @param points  in samples from pixel (0, 0); the window repeats after nx × ny samples
/// @return        shape (ny, nx): 1 where a sample's centre is covered, else 0
Array2D<float> silhouette_of(const std::vector<PointOnSlice>& points, int nx, int ny);

}  // namespace holotrace
