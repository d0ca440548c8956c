#pragma once

#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/data/scene.h"

namespace holotrace {

/// Distances from the panel between which nearly all of a kind of visible things lie [m]; negative in front of it.
struct DepthRange {
  double nearest = 0, farthest = 0;
};

/// The depths of what the panel shows inside its own window, for rays from all over the panel, in its diffraction
/// cone. One range has the surfaces that the rays meet first and the luminous points, one the images behind mirrors and
/// glass, at their apparent distances (follow_specular). What lies beside the panel's width and height is left out, and in
/// each range the 0.5 % nearest and farthest places. Images count if at least a tenth of the light comes by them, and if
/// one place in 100 is an image. Ranges that overlap become one; they are in the order of their depths. None if nothing is
/// there.
/// @throws Error  as PathScene does
std::vector<DepthRange> depth_ranges(const Scene& scene, const Grid& panel, double wavelength);

}  // namespace holotrace
