#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/base/vec.h"
#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"

namespace holotrace {

/// Spatial frequency (sin αx, sin αy)/λ of the off-axis reference [1/m]. Both angles 0: (3/8p, 0)
/// with bias, where the widest band, ±1/8p, is told apart, and (1/4p, 0) without, half of what the pitch p holds.
/// @throws Error unless both frequencies are below 1/2p and one of them is not 0.
Vec2 reference_carrier(const EncodeParams& params, const Grid& grid, double wavelength);

/// The stop that lets through the term U·R* of an off-axis hologram under an axial plane wave: centred at
/// −carrier. The other terms are told apart along the axis in which the carrier is the larger, f:
/// |U|² + |R|² lie around 0, |U|² twice as wide as U, the twin U*·R around f, and around f − 1/p by the
/// panel's orders. So the half width there is f/3 with bias (f − B = 2B), f less one bin of the panel's
/// spectrum without, never beyond 1/2p − f; along the other axis it is a whole order, 1/2p.
SpectralFilter off_axis_filter(Vec2 carrier, const Grid& grid, bool with_bias);

/// Interference of the field with a plane wave, as transmittances:
///
///     I = |U|² + |R|² + 2Re(U·R*)  with bias,   I = 2Re(U·R*) − min  without     (Eq. 8–10)
///     R = ρ·max|U|·exp(2πi(u·x + v·y)),   (u, v) the carrier, ρ = params.reference_ratio
///
/// Writes `level`, `filter` and `illumination` of the hologram, whose grid, levels and wavelength are set.
/// Facts: `carrier_u`, `carrier_v` [1/m], `modulus_max` [√(W/m²)], `band_power`: the fraction of the field's
/// power that lies in the half width of the stop. Warns where that is less than 0.99.
void encode_off_axis(const Field& field, const EncodeParams& params, const Observer& observer, Hologram& hologram);

/// Fact `band_power`: the part of the field's power that the stop of a hologram with a tilted reference lets through.
/// Warns where that is less than 0.99.
void tell_band_power(const Field& field, const SpectralFilter& filter, bool with_bias, const char* encoder,
                     const Observer& observer);

}  // namespace holotrace
