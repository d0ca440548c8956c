#pragma once

#include <vector>

#include "holotrace/data/scene.h"

namespace holotrace {

/// The turn about y, one of four quarters, after which a model shows most from the front and above: for files whose
/// format does not say where the front is. What it shows is the sum of the differences of the normals of neighbouring
/// pixels, each at most 1, over a picture in parallel projection, with 1 for each pixel of its outline.
/// @param view  from the upright model's frame to that of the picture, which is seen along −z
/// @return      0, 1, 2 or 3 quarters; the smallest, where all show the same
int quarter_that_shows_most(const std::vector<Mesh>& meshes, const Frame& view);

}  // namespace holotrace
