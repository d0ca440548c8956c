#pragma once

#include <vector>

#include "holotrace/data/grid.h"
#include "holotrace/wave/triangles/triangle_tile.h"

namespace holotrace {

/// How parts of triangles will be summed, and the relative L2 error that is expected of it, the root of the energy of
/// all errors over that of the parts.
struct TriangleChoice {
  TileShape tile{};
  double faint = 0;   ///< see sum_triangle_tile [√(W/m²)]
  double error = 0;   ///< expected
  double energy = 0;  ///< that the parts bring to the panel, phases random, per pixel area [W/m²]
  bool meets_tolerance = false;
};

/// The largest tile whose measured error, with a margin of a quarter, keeps the tolerance, and the threshold whose
/// faint terms add no more than half the tolerance; the most accurate tile if none does.
///
/// At 2048 places, drawn from a fixed seed, half of them evenly over the parts' boxes and half over their lobes, the
/// polynomial and the split of the wave are compared with the envelope of the part cut four times.
///
/// @param coherence  energy of the field over the sum of its parts' energies, if known to be below 1
TriangleChoice choose_triangle_tile(const std::vector<TrianglePart>& parts, const Grid& grid, double wavelength,
                                    double tolerance, double coherence = 1);

}  // namespace holotrace
