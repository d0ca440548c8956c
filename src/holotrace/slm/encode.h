#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params.h"
#include "holotrace/data/slm.h"

namespace holotrace {

/// The levels that make a panel show a field.
///
///     phase      ℓ = arg(U)·M/2π, rounded, mod M: the kinoform; |U| is dropped
///     amplitude  ℓ = (M−1)·|U|/max|U|: arg(U) is dropped
///     off-axis   ℓ = (M−1)·I/max I, I = |U|² + |R|² + 2Re(U·R*) (Eq. 9, 10), R a tilted plane wave
///
/// U is the field, or its conjugate where `params.image` is the real image. Off-axis keeps both modulus
/// and phase, in one diffraction order: see off_axis.h; the hologram names the stop that selects it. The
/// amplitude encodings may be asked of a phase panel: the hologram then is one of amplitudes, and a
/// warning says that a crossed polariser is taken for granted.
///
/// @param field   at the panel, shape of the SLM's grid [√(W/m²)], its scale is lost
/// @param slm     the panel
/// @param params  encoding, image side, reference wave, levels M (0: those of the panel)
/// @return        levels, shape (ny, nx), for the field's wavelength
/// @throws Error  if the grids differ, samples are not finite, the encoding does not fit the panel, M is
///                not 2 … 65536 or more than the panel has, or the reference is too steep for the pitch
/// Facts: `encoder`, `levels`; of the amplitude encoding `modulus_max` [√(W/m²)], which the top level stands
/// for (nothing is clipped), and `mean_transmittance`; those of off_axis.h.
Hologram encode(const Field& field, const Slm& slm, const EncodeParams& params, const Observer& observer = {});

}  // namespace holotrace
