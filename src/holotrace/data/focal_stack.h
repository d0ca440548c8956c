#pragma once

#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// Pictures of one scene in several planes behind the panel or in front of it, each with that plane in focus. The panel is the lens: a
/// pixel is the mean radiance of the rays that leave the panel and, followed backwards, cross the pixel.
struct FocalStack {
  Grid grid;                      ///< pixels of every plane, centred on the axis, with the panel's pitch
  std::vector<double> distances;  ///< distances of the planes from the panel [m], negative in front of it
  std::vector<Image> pictures;    ///< linear radiance [W/m²/sr], one per plane, 1 or 3 channels, shape of `grid`
};

/// @throws Error unless the stack has planes at finite distances other than 0, and for each a picture of the grid's size with
///         one number of channels, 1 or 3, and finite values of 0 or more.
void check_focal_stack(const FocalStack& stack);

}  // namespace holotrace
