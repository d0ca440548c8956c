#pragma once

#include <string>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/synthesize.h"
#include "holotrace/data/sources.h"

namespace holotrace {

/// Field on the panel of a set of sources, by the method that the parameters name:
///
/// - `exact`: one by one in double precision (sum_exact.h); the reference;
/// - `tiled`: tile by tile, as matrix products (sum_tiled.h);
/// - `planes`: by a non-uniform FFT in every tile (sum_planes.h);
/// - `layers`: by slices of depth (layers/sum_layers.h);
/// - `auto`: the one of `tiled` and `planes` that the cost model expects to be faster within the tolerance; `exact`
///   where neither meets it. Never `layers`, which cannot cut waves at their boxes.
///
/// Waves with an amplitude in each tile of the panel (TileAmplitudes) are summed tile by tile by every method, at the
/// cost of the waves·pixels that they light.
///
/// @param sources  spherical waves at z < 0 [m]
/// @param grid     panel pixels: nx, ny, pitch [m]
/// @return         complex amplitude, shape (ny, nx) [√(W/m²)]
/// @throws Error   for no sources, a source not behind the panel, or a tolerance that is not in (0, 1)
///
/// Facts: `waves`, `waves_pixels`, `method`, of `auto` also `why`; those of the method. Warning: waves whose box misses
/// the panel.
Field synthesize(const Sources& sources, const Grid& grid, const SynthesizeParams& params,
                 const Observer& observer = {});

/// The name of a method as flags and scenes have it.
std::string method_name(SynthesisMethod method);

/// The waves·pixels that the boxes of the sources hold: the work of a summation.
int64_t waves_pixels(const Sources& sources, const Grid& grid);

}  // namespace holotrace
