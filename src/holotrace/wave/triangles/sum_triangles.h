#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Field on the panel of emitting triangles (Triangle), each in the pixels that it lights (cut_triangles).
///
/// Seen from the panel, a triangle is the spherical wave of its centroid times its Fourier transform, which has a
/// closed form (triangle_moments.h); the curvature of the wave fronts across it (its bulge) is a quadratic polynomial.
/// In a tile the wave is split into a column times a row. The transform is smooth there and is replaced by a polynomial
/// of degree 3 (triangle_part.h). The sum is a matrix product with up to four terms for each part.
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

/// Field on the panel of emitting triangles (Triangle), each in the pixels that it lights (cut_triangles), pixel by
/// pixel in double: the slow reference of sum_triangles, computed in space.
///
/// @param triangles  corners at z < 0 or z > 0 [m]
/// @param grid       panel pixels: nx, ny, pitch [m]
/// @param bulge      largest bulge of a part [rad], see PartLimits; the relative L2 error is about bulge²/13
/// @return           complex amplitude, shape (ny, nx) [√(W/m²)]
/// @throws Error     as check_triangles and cut_triangles do
///
/// Cost: about 0.3 µs per part and pixel in its box.
FieldDouble sum_triangles_exact(const Triangles& triangles, const Grid& grid, double bulge = 0.01,
                                const Observer& observer = {});

/// The same light by its angular spectrum, in closed form at every frequency: the slow reference in frequency.
///
///     Û(u, v) = 1/(λ·w)·∬ a(s)·exp(iφ(s))·exp(−2πi(u·x + v·y + w·z)) |n·e| dA,   w = √(1/λ² − u² − v²)
///
/// The band is limited to |u|, |v| ≤ 1/2p and, for each triangle, to frequencies whose light stays inside the padded
/// window on its way from the centroid to the panel. One inverse FFT then gives the field on the panel. The window is
/// the panel with a margin that keeps light from wrapping around to the other side. It is at most `padding` panels
/// wide, which then limits the band (as Matsushima and Shimobaba's limit, Opt. Express 17, 19662, 2009).
///
/// The light is limited by the band instead of by boxes of pixels. Both cut it at nearly the same places: where the
/// boxes cover the panel, this field and that of sum_triangles_exact agree.
///
/// Cost: some 100 ns per triangle and frequency in its band.
FieldDouble sum_triangles_spectrum(const Triangles& triangles, const Grid& grid, int padding = 4,
                                   const Observer& observer = {});

}  // namespace holotrace
