#pragma once

#include <cstdint>

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

/// Error of a field against sum_exact of the same sources, estimated from some of its pixels. Use it where the exact
/// sum over the whole panel would take hours.
///
///     error = √(Σ|u − U|² / Σ|U|²)  over `pixels` pixels drawn at random, U summed in double by wave_at
///
/// U is summed on the field's own grid, with the sources' tile amplitudes.
///
/// @param pixels  number of pixels to draw, at least 1; all pixels are equally likely, and one may be drawn twice. If
///                the error is spread evenly, the error's square is that of the whole field within about 1/√pixels
/// @param seed    seed of the draw; the same seed draws the same pixels
/// @return        relative L2 error; 0 if the field equals U at all drawn pixels, infinite if only U is 0
/// @throws Error  if the field and the sources have different wavelengths, or for fewer than one pixel
///
/// Cost: a square root, a sine and a cosine per wave and drawn pixel in its box, on all threads.
double sampled_error(const Field& field, const Sources& sources, int pixels, uint64_t seed = 1);
double sampled_error(const FieldDouble& field, const Sources& sources, int pixels, uint64_t seed = 1);

}  // namespace holotrace
