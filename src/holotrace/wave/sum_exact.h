#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Field on the panel of a set of waves, summed one by one in double precision. Every faster method is
/// compared with this sum.
///
///     U(p) = Σⱼ aⱼ·d₀ⱼ/rⱼ(p)·exp(i(2π·rⱼ(p)/λ + φⱼ)),   rⱼ = ‖p − oⱼ‖,  p inside the box of j   (Eq. 7, 13)
///
/// Astigmatic waves have the field of AstigmaticWave. With tile amplitudes (TileAmplitudes), aⱼ is the amplitude in the tile that p lies in.
///
/// @param sources  waves from z < 0 or to z > 0 [m]
/// @param grid     panel pixels: nx, ny, pitch [m]
/// @return         complex amplitude, shape (ny, nx) [√(W/m²)], within 1e-11 of the sum above
/// @throws Error   for a source that is not finite or on the panel, naming it
///
/// Cost: a square root, a sine and a cosine per wave and pixel in its box.
FieldDouble sum_exact(const Sources& sources, const Grid& grid, const Observer& observer = {});

}  // namespace holotrace
