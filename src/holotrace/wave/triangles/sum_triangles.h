#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/triangles.h"

namespace holotrace {

/// Field on the panel of emitting triangles (Triangle), each in the pixels that it lights (cut_triangles).
///
/// Seen from the panel, a triangle is the spherical wave of its centroid times its Fourier transform, which has a
/// closed form (triangle_moments.h); the curvature of the wave fronts across it (its bulge) is a quadratic polynomial.
/// In a tile the wave is split into a column times a row. The transform is smooth there and is replaced by a polynomial
/// of degree 3 (triangle_tile.h). The sum is a matrix product with up to four terms for each part.
///
/// Triangles are cut until the bulge of their parts causes less than a third of the tolerance. The tile is the largest
/// one whose error keeps the rest, measured at 2048 places drawn from these parts. Terms that are faint enough are left
/// out.
///
/// @param triangles  corners at z < 0 or z > 0 [m], at least one triangle
/// @param grid       panel pixels: nx, ny, pitch [m]
/// @param tolerance  bound on the relative L2 error against sum_triangles_exact, 1e-5 or more
/// @return           complex amplitude, shape (ny, nx) [√(W/m²)]; the same bytes on any number of threads
/// @throws Error     for triangles that check_triangles or cut_triangles rejects, and a tolerance that cannot be met
///
/// Facts: the triangles, the parts, the tile and the expected error. Warning: triangles that light no
/// pixel.
///
/// Cost: 4 multiply-adds per part, pixel in its box and term (1 to 4 terms), and some 300 ns per part and tile.
/// Memory: the field, and 240 bytes per part.
Field sum_triangles(const Triangles& triangles, const Grid& grid, double tolerance, const Observer& observer = {});

}  // namespace holotrace
