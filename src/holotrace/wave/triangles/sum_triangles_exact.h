#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/triangles.h"

namespace holotrace {

/// Field on the panel of triangles that shine (Triangle), each in the pixels that it lights (cut_triangles), pixel by
/// pixel in double: the slow twin of sum_triangles in space.
///
/// @param triangles  corners at z < 0 [m]
/// @param grid       panel pixels: nx, ny, pitch [m]
/// @param bulge      see PartLimits; the relative L2 error is about bulge²/13
/// @return           complex amplitude, shape (ny, nx) [√(W/m²)]
/// @throws Error     as check_triangles and cut_triangles do
///
/// Cost: about 0.3 µs per part and pixel in its box.
FieldDouble sum_triangles_exact(const Triangles& triangles, const Grid& grid, double bulge = 0.01,
                                const Observer& observer = {});

/// The same light by way of its angular spectrum, in closed form at every frequency: the slow twin in frequency.
///
///     Û(u, v) = 1/(λ·w)·∬ a(s)·exp(iφ(s))·exp(−2πi(u·x + v·y + w·z)) |n·e| dA,   w = √(1/λ² − u² − v²)
///
/// band-limited to |u|, |v| ≤ 1/2p and, for each triangle, to the frequencies that stay inside the padded window on
/// their way from its centroid to the panel; one inverse FFT brings it to the panel. The window is the panel and,
/// around it, as much as keeps what leaves it from coming in again on the other side; at most `padding` panels wide,
/// which then limits the band (as Matsushima and Shimobaba's, Opt. Express 17, 19662, 2009).
///
/// Instead of by boxes of pixels the light is limited by the band, which cuts it nearly at the same places: where the
/// boxes cover the panel both twins agree.
///
/// Cost: some 100 ns per triangle and frequency in its band.
FieldDouble sum_triangles_spectrum(const Triangles& triangles, const Grid& grid, int padding = 4,
                                   const Observer& observer = {});

}  // namespace holotrace
