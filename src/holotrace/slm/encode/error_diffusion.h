#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/phase_levels.h"

namespace holotrace {

/// Phases whose errors are passed to neighbouring pixels (Tsang and Poon, Opt. Express 21, 23680, 2013). Each pixel
/// gets the level nearest to the phase of t = U/A + the errors received. Its complex error t − exp(iφ), with rounding,
/// is passed on with the weights of Floyd and Steinberg (Proc. SID 17, 75, 1976): 7/16 ahead, 3/16, 5/16, 1/16 in the
/// next row. Every other row runs backward, so that no direction is preferred. Errors that leave the panel are lost.
///
/// The error has a high-pass spectrum, 0 on the axis. The stop |u|, |v| ≤ params.stop/2p of the hologram blocks most of
/// it. The field is limited to the stop beforehand. A is the modulus that 1 in 1000 pixels exceeds; these pixels are
/// clipped, because errors of moduli above 1 would grow without limit. E = A².
///
/// Pixels depend on the ones before, so it runs on one thread of the processor: about 50 ns per pixel.
/// @throws Error  for a stop outside (0, 1]
/// Facts: those of low_pass.h.
void encode_error_diffusion(const Field& field, const PhaseLevels& levels, const EncodeParams& params,
                            const Observer& observer, Hologram& hologram);

}  // namespace holotrace
