#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/slm/encode/phase_levels.h"
#include "holotrace/slm/encode/sample_kernels.h"

// The encoders that treat each pixel by itself. Each writes `level` and `illumination` of a hologram whose grid,
// levels, wavelength and modulation are set. `field` is what the panel is to show: U, or its conjugate.

namespace holotrace {

/// The moments of |U| over the panel.
ModulusMoments modulus_moments(const Field& field);

/// Kinoform: the level nearest to arg(U); |U| is dropped. The panel shows exp(i·arg U). Its part along U is
/// ⟨|U|⟩/⟨|U|²⟩·U: E = (⟨|U|²⟩/⟨|U|⟩)².
void encode_phase(const Field& field, const PhaseLevels& levels, Hologram& hologram);

/// Level (M−1)·|U|/max|U|; arg(U) is dropped. E = max|U|².
/// Facts: `modulus_max` [√(W/m²)], `mean_transmittance`.
void encode_amplitude(const Field& field, const Observer& observer, Hologram& hologram);

/// Phase and amplitude, on a panel that modulates both: `level` as the kinoform, `modulus_level` as the amplitude
/// encoding. E = max|U|².
/// Facts: as encode_amplitude.
void encode_complex(const Field& field, const PhaseLevels& levels, const Observer& observer, Hologram& hologram);

}  // namespace holotrace
