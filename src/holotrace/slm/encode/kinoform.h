#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/shown_pixels.h"

// The encoders that treat each pixel by itself. Each writes `level` and `illumination` of a hologram whose grid,
// levels, wavelength and modulation are set.

namespace holotrace {

/// The moments of |U| over the panel.
ModulusMoments modulus_moments(const Field& field);

/// Kinoform: the level nearest to arg(U); |U| is dropped. The panel shows exp(i·arg U). Its part along U is
/// ⟨|U|⟩/⟨|U|²⟩·U: E = (⟨|U|²⟩/⟨|U|⟩)².
template <class AnyField>
void encode_phase(const ShownPixels<AnyField>& shown, const PhaseLevels& levels, Hologram& hologram);

/// Level (M−1)·|U|/max|U|; arg(U) is dropped. E = max|U|².
/// Facts: `modulus_max` [√(W/m²)], `mean_transmittance`.
template <class AnyField>
void encode_amplitude(const ShownPixels<AnyField>& shown, const Observer& observer, Hologram& hologram);

/// Phase and amplitude, on a panel that modulates both: `level` as the kinoform, `modulus_level` as the amplitude
/// encoding. E = max|U|².
/// Facts: as encode_amplitude.
template <class AnyField>
void encode_complex(const ShownPixels<AnyField>& shown, const PhaseLevels& levels, const Observer& observer,
                    Hologram& hologram);

}  // namespace holotrace
