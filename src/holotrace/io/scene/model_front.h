#pragma once

#include <vector>

#include "holotrace/data/scene.h"

namespace holotrace {

/// The turn about y [rad] after which a model shows most: for files whose format does not say where the front is. What it
/// shows is the sum of the differences of the normals of neighbouring
/// pixels, each at most 1, over a picture in parallel projection, with 1 for each pixel of its outline. What is
/// nearer counts more, so that a head looks at the viewer.
/// @param turns  to choose from; the first one is taken unless another shows 1 % more
/// @param view   from the turned model's frame to that of the picture, which is seen along −z
double turn_that_shows_most(const std::vector<Mesh>& meshes, const std::vector<double>& turns, const Frame& view);

}  // namespace holotrace
