#pragma once

#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/wave/layers/spread.h"

namespace holotrace {

/// How far each point of a set hides what lies behind it: the radius of its disc. It is the largest distance, in the
/// plane, to the four points that are nearest in space, divided by √2. Discs of this radius just cover a square lattice
/// of points, and 84 % of a random scatter. The radius does not depend on the slices. It is at most three times the
/// median and at least half a sample; a lone point has half a sample.
///
/// @param points  points, in samples from pixel (0, 0)
/// @param depths  depth of each point, in samples too
/// @return        radius of each point's disc [samples]
std::vector<double> silhouette_radii(const std::vector<PointOnSlice>& points, const std::vector<double>& depths);

/// The mask of a slice's points: each hides what is behind its disc.
///
/// @param points  points, in samples from pixel (0, 0); the window repeats after nx × ny samples
/// @return        shape (ny, nx): 1 where a disc covers the sample's centre, else 0
Array2D<float> silhouette_of(const std::vector<PointOnSlice>& points, const std::vector<double>& radii, int nx, int ny);

}  // namespace holotrace
