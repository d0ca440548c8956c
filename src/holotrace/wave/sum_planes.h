#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Field on the panel of a set of spherical waves, by a non-uniform FFT in every tile of the
/// panel: the same sum as sum_exact.h, box for box.
///
/// In a tile, around its reference pixel at the distance r₀ and the position (x, y) from a wave's origin, the wave is
///
///     a·(d₀/r₀)·exp(2πi(r₀/λ + φ₀/2π + (x·u + y·v)/λr₀ + κ(u² + v²)/2)),   κ = (1 − ρ²/2r₀²)/λr₀
///
/// a plane wave of the frequency (x, y)/λr₀ times a curvature. Waves of similar depth form a slab. A slab has a few
/// nodes of fixed curvature (Chebyshev points), among which a wave is shared out by Lagrange weights. On each node's
/// grid the wave is added to the cells around its frequency by the gridding kernel of a non-uniform FFT; an FFT of the
/// grid then gives the tile.
/// Neglected are the phases ∝ u·v, u² − v² and of third order, and the slope of the modulus. They depend on frequency
/// and curvature alone; if the tolerance requires it, four more FFTs correct them to first order. A wave whose box cuts
/// a tile parallel to an axis is added in strips of 16 lines, exact across and gridded along. Waves are summed directly
/// (sum_tiled.h) in tiles that contain a corner of their box, and everywhere if their box is only a few tiles wide.
///
/// @param sources    spherical waves at z < 0 [m]
/// @param grid       panel pixels: nx, ny, pitch [m]
/// @param tolerance  bound on the relative L2 error against sum_exact, 1e-5 or more
/// @return           complex amplitude, shape (ny, nx) [√(W/m²)]; the same bytes on any number of threads
/// @throws Error     for a source not behind the panel, naming it, and for a tolerance that no plan can meet
///
/// Cost: about width²·nodes multiply-adds per wave and tile (not per pixel): tens of times less than sum_tiled for many
/// waves. Memory: the field, 340 bytes per wave, 27 MB per thread.
Field sum_planes(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer = {});

}  // namespace holotrace
