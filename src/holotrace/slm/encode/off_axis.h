#pragma once

#include <cstdint>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/reference_wave.h"
#include "holotrace/slm/encode/shown_pixels.h"

namespace holotrace {

/// Spatial frequency (sin αx, sin αy)/λ of the off-axis reference [1/m]. If both angles are 0: (3/8p, 0)
/// with bias, which separates the widest band, ±1/8p; (1/4p, 0) without, half the Nyquist frequency of the pitch p.
/// @throws Error  unless both frequencies are below 1/2p and one of them is not 0
Vec2 reference_carrier(const EncodeParams& params, const Grid& grid, double wavelength);

/// The stop that passes the term U·R* of an off-axis hologram under an axial plane wave. It is centred at
/// −carrier. The other terms are separated along the axis in which the carrier is larger, at f:
/// |U|² + |R|² lie around 0, with |U|² twice as wide as U; the twin U*·R lies around f and, by the panel's
/// orders, around f − 1/p. The half width along this axis is f/3 with bias (f − B = 2B), f less one bin of
/// the panel's spectrum without, and at most 1/2p − f. Along the other axis it is a whole order, 1/2p.
SpectralFilter off_axis_filter(Vec2 carrier, const Grid& grid, bool with_bias);

/// Interference of the field with a plane wave, as transmittance I/max I:
///
///     I = |U|² + |R|² + 2Re(U·R*)  with bias,   I = 2Re(U·R*) − min  without     (Eq. 8–10)
///     R = ρ·max|U|·exp(2πi(u·x + v·y)),   (u, v) the carrier, ρ = params.reference_ratio
///
/// Writes `level`, `filter` and `illumination` of the hologram, whose grid, levels and wavelength are set.
/// Facts: `carrier_u`, `carrier_v` [1/m], `modulus_max` [√(W/m²)], `band_power`: the fraction of the field's
/// power within the half width of the stop. Warning: `band_power` below 0.99.
template <class AnyField>
void encode_off_axis(const ShownPixels<AnyField>& shown, const EncodeParams& params, const Observer& observer,
                     Hologram& hologram);

/// The fraction of the field's power in the band |u| ≤ half_u, |v| ≤ half_v.
double power_inside(const ShownPixels<Field>& shown, const SpectralFilter& filter);

/// Fact `band_power`: the fraction `inside` of the field's power that passes the stop of a hologram with a tilted reference.
/// Warning: `band_power` below 0.99.
void tell_band_power(double inside, const Hologram& hologram, bool with_bias, const Observer& observer);

}  // namespace holotrace
