#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Field on the panel of a set of spherical waves, summed tile by tile.
///
///     U(p) = Σⱼ aⱼ·d₀ⱼ/rⱼ(p)·exp(i(2π·rⱼ(p)/λ + φⱼ)),   rⱼ = ‖p − oⱼ‖,  p inside the box of j   (Eq. 7, 13)
///
/// Inside a tile r is split as r₀ + Δr(column) + Δr(row). The wave is then one number times a column
/// times a row, and the sum over waves is a complex matrix product. The neglected phase, about
/// k·x₀·y₀·u·v/r₀³, is kept below `tolerance` by the choice of the tile's shape (tile_error.h). If the waves
/// partly cancel, their relative error grows; the sum is then repeated with smaller tiles.
///
/// With tile amplitudes (TileAmplitudes), aⱼ is the amplitude in the panel tile that p lies in. The sum is then made
/// for one panel tile after the other, each within the tolerance.
///
/// @param sources    spherical waves at z < 0 [m]
/// @param grid       panel pixels: nx, ny, pitch [m]
/// @param tolerance  bound on the relative L2 error against sum_exact, 1e-5 or more
/// @return           complex amplitude, shape (ny, nx) [√(W/m²)]; the same bytes on any number of threads
/// @throws Error     for a source not behind the panel, naming it, and for a tolerance that no tile can meet
///
/// Facts: those of try_sum (summation.h).
///
/// Cost: 3 multiply-adds per wave and pixel in its box, and a sine and cosine per wave and per column
/// and row of the tiles it meets.
Field sum_tiled(const Sources& sources, const Grid& grid, double tolerance, const Observer& observer = {});

}  // namespace holotrace
