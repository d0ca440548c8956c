#pragma once

#include <optional>
#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/data/grid.h"
#include "holotrace/wave/triangles/triangle_tile.h"

namespace holotrace {

/// How parts of triangles are summed, and the relative L2 error that is expected: the root of the energy of all errors
/// over the energy of the parts.
struct TriangleChoice {
  TileShape tile{};
  double faint = 0;   ///< see sum_triangle_tile [√(W/m²)]
  double error = 0;   ///< expected relative L2 error
  double energy = 0;  ///< energy that the parts bring to the panel, with random phases, over the pixel's area [W/m²]
  bool meets_tolerance = false;
};

/// Chooses the largest tile whose measured error, with a margin of 25 %, keeps the tolerance, and the threshold below
/// which dropped terms add at most half the tolerance. If no tile keeps it, the most accurate one.
///
/// The error is measured at 2048 places drawn from a fixed seed, half evenly over the parts' boxes and half over their
/// main lobes. There the polynomial and the split wave are compared with the envelope of the part cut four times.
///
/// @param coherence  energy of the field over the sum of its parts' energies; 1 if it is not known to be smaller
TriangleChoice choose_triangle_tile(const std::vector<TrianglePart>& parts, const Grid& grid, double wavelength,
                                    double tolerance, double coherence = 1);

/// The relative L2 error of a sum of parts, measured against their exact light at pixels of the field: half of them drawn
/// by its light, half evenly. None for so many parts that fewer than 64 pixels could be compared: the errors of many parts
/// average out, so that the expected error is met.
///
/// @param field  the sum
/// Cost: 100,000 parts at a pixel, some 5 µs each.
std::optional<double> measured_triangle_error(const std::vector<TrianglePart>& parts, const Field& field);

}  // namespace holotrace
