#pragma once

#include <cstdint>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/shown_pixels.h"

namespace holotrace {

/// A complex field as two alternating phases, on a checkerboard (Hsueh and Sawchuk, Appl. Opt. 17, 3874, 1978; on one
/// panel Mendoza-Yero et al., Opt. Lett. 39, 1740, 2014):
///
///     φ± = arg U ± acos(|U|/A),   + where column + row is even,   so   exp(iφ±) = U/A ± i·exp(i·arg U)·√(1 − |U|²/A²)
///
/// Each pixel uses the field at its own place, so nothing is shifted. The first term is exactly the field. The second
/// is noise on a carrier at the panel's corner frequency (1/2p, 1/2p). The stop |u|, |v| ≤ params.stop/2p of the
/// hologram blocks it, except where the noise's own band reaches into the stop. The field is limited to the stop
/// beforehand. The method suits smooth phases; with a random phase the noise fills the whole band.
///
/// A is the modulus that 1 in 1000 pixels exceeds; these pixels are clipped. E = A².
/// @throws Error  for a stop outside (0, 1]
/// Facts: those of low_pass.h.
template <class AnyField>
void encode_double_phase(const ShownPixels<AnyField>& shown, const PhaseLevels& levels, const EncodeParams& params,
                         const Observer& observer, Hologram& hologram);

/// The level of φ± at each pixel, for samples of modulus 1 or less, or for their conjugates. They are overwritten.
void write_double_phase_levels(Field& inside, bool is_conjugate, const PhaseLevels& levels, Array2D<uint16_t>& to);

}  // namespace holotrace
