#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/phase_levels.h"

namespace holotrace {

/// Phases whose errors go to their neighbours (Tsang and Poon, Opt. Express 21, 23680, 2013): pixel by pixel, the level
/// nearest to the phase of t = U/A + what came from before, and the complex error t − exp(iφ), rounding included,
/// onward with the weights of Floyd and Steinberg (Proc. SID 17, 75, 1976): 7/16 ahead, 3/16, 5/16 and 1/16 in the next
/// row. Every other row runs backward, so that no direction is preferred. What leaves the panel is lost.
///
/// The error has the spectrum of a high pass, 0 on the axis: the stop |u|, |v| ≤ params.stop/2p that the hologram asks
/// for keeps most of it out. The field is cut to the stop beforehand. A is the modulus that 1 in 1000 pixels exceed;
/// those are clipped, as errors of moduli above 1 would grow without end. E = A².
///
/// One pixel after the other by nature, so on one thread: about 50 ns a pixel.
/// @throws Error  for a stop outside (0, 1]
/// Facts: those of low_pass.h.
void encode_error_diffusion(const Field& field, const PhaseLevels& levels, const EncodeParams& params,
                            const Observer& observer, Hologram& hologram);

}  // namespace holotrace
