#pragma once

#include <cstdint>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/reference_wave.h"
#include "holotrace/slm/encode/shown_pixels.h"

namespace holotrace {

/// A hologram of two levels, chosen by the sign of the interference with a tilted plane wave R,
///
///     b = 1 where Re(U·R*) ≥ 0, else 0
///
/// (a binary Fourier or Fresnel hologram; Lohmann and Paris, Appl. Opt. 6, 1739, 1967). |U| is dropped. As a function
/// of arg(U·R*) = ψ this is a square wave, sgn cos ψ = 4/π·(cos ψ − cos 3ψ/3 + …). The order that shows exp(i·arg U)
/// has, before the roll-off of the pixels,
///
///     phase      levels 0 and half a turn:  2/π of the amplitude, 4/π² = 40.5 % of the light
///     amplitude  levels 0 and M−1:          1/π of the amplitude, 1/π² = 10.1 %
///
/// Harmonics that the pixels alias into this order change these values; the change is small if arg U is spread evenly,
/// as for a diffuse scene. R and the stop are those of the off-axis hologram without bias: off_axis.h.
///
/// Facts: `carrier_u`, `carrier_v` [1/m], `order_efficiency` as above, `band_power`. Warns as off-axis does.
/// Illumination: E = (⟨|U|²⟩/⟨|U|⟩)²/efficiency.
template <class AnyField>
void encode_binary(const ShownPixels<AnyField>& shown, const PhaseLevels& levels, const EncodeParams& params,
                   const Observer& observer, Hologram& hologram);

}  // namespace holotrace
