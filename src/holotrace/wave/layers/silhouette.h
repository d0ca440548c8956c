#pragma once

#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/wave/layers/spread.h"

namespace holotrace {

/// How far each of a set of points hides what lies behind it: the disc reaches to the farthest in the plane of the
/// four points that are nearest in space, over √2 (a square lattice of points is just covered, and 84 % of a random
/// scatter). It does not depend on how points are put into slices. At most three times the median, at least half a
/// sample, which a lone point has.
///
/// @param points  in samples from pixel (0, 0)
/// @param depths  of each, in samples too
/// @return        radius of each [samples]
std::vector<double> silhouette_radii(const std::vector<PointOnSlice>& points, const std::vector<double>& depths);

/// What the points of a slice hide: a disc each.
///
/// @param points  in samples from pixel (0, 0); the window repeats after nx × ny samples
/// @return        shape (ny, nx): 1 where a sample's centre is covered, else 0
Array2D<float> silhouette_of(const std::vector<PointOnSlice>& points, const std::vector<double>& radii, int nx, int ny);

}  // namespace holotrace
