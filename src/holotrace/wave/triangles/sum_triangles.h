#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/triangles.h"

namespace holotrace {

/// Field on the panel of triangles that shine (Triangle), each in the pixels that it lights (cut_triangles).
///
/// Seen from the panel a triangle is the spherical wave of its centroid times its Fourier transform, which is known in
/// closed form (triangle_moments.h), with the bulge of the wave fronts across it as a quadratic polynomial. Tile by
/// tile the wave is split into a column times a row, and the transform, which is smooth there, is a polynomial of
/// degree 3 (triangle_tile.h): a matrix product of up to four terms for each triangle.
///
/// Triangles are cut until the bulge of their parts leaves less than a third of the tolerance; the tile is the
/// largest whose error, measured on 2048 places drawn from the very parts, keeps the rest; terms that are faint enough
/// are left out.
///
/// @param triangles  corners at z < 0 [m], at least one triangle
/// @param grid       panel pixels: nx, ny, pitch [m]
/// @param tolerance  bound on the relative L2 error against sum_triangles_exact, 1e-5 or more
/// @return           complex amplitude, shape (ny, nx) [√(W/m²)]; the same bytes on any number of threads
/// @throws Error     for triangles that check_triangles or cut_triangles refuses, and a tolerance that cannot be met
///
/// Tells its observer the triangles, the parts, the tile and the expected error; warns of triangles that light no
/// pixel.
///
/// Cost: 4 multiply-adds per part, pixel in its box and term, 1 to 4 of them, and some 300 ns per part and tile.
/// Memory: the field, and 240 bytes per part.
Field sum_triangles(const Triangles& triangles, const Grid& grid, double tolerance, const Observer& observer = {});

}  // namespace holotrace
