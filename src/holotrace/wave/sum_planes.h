#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Field on the panel of a set of spherical waves, by a non-uniform FFT in every tile of the
/// panel: the same sum as sum_exact.h, box for box.
///
/// In a tile, around its pixel at the distance r₀ and the place (x, y) from a wave's origin, the wave is nearly
///
///     a·(d₀/r₀)·exp(2πi(r₀/λ + φ₀/2π + (x·u + y·v)/λr₀ + κ(u² + v²)/2)),   κ = (1 − ρ²/2r₀²)/λr₀
///
/// a plane wave of the frequency (x, y)/λr₀ times a curvature. Waves of similar depth, a slab, go to a few nodes,
/// fixed curvatures (Chebyshev points, Lagrange's weights): to the cells around their frequency in a node's grid, by
/// the gridding kernel of a non-uniform FFT. An FFT of each node's grid makes the tile. What that neglects (the phases
/// ∝ u·v, u² − v² and of third order, and the slope of the modulus) depends on frequency and curvature alone, and is
/// corrected to first order by four more FFTs where the tolerance needs it. Tiles that a box cuts parallel to an axis
/// take the wave in strips of 16 lines, exact across and gridded along; where a box has its corner, and for waves whose
/// box is only a few tiles wide, the waves are summed directly (sum_tiled.h).
///
/// @param sources    spherical waves at z < 0 [m]
/// @param grid       panel pixels: nx, ny, pitch [m]
/// @param tolerance  bound on the relative L2 error against sum_exact, 1e-5 or more
/// @return           complex amplitude, shape (ny, nx) [√(W/m²)]; the same bytes on any number of threads
/// @throws Error     for a source not behind the panel, naming it, and a tolerance that no plan meets
///
/// Cost: about width²·nodes multiply-adds per wave and tile, not pixel: for many waves tens of times less than
/// sum_tiled. Memory: the field, 340 bytes per wave, 15 MB per thread.
Field sum_planes(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer = {});

}  // namespace holotrace
