#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"

namespace holotrace {

/// One diffraction order, as selected by a stop in the middle of a 4f system, and moved to the axis.
///
///     V(u, v) = U(u, v) where |u − u0| ≤ half_u and |v − v0| ≤ half_v, else 0
///     out(x, y) = v(x, y)·exp(−2πi(u0·x + v0·y))
///
/// Unit magnification and no inversion. The spectrum is that of the samples without padding, so the field counts as
/// one period of a periodic field. The carrier is removed in double precision and need not fall on a bin.
///
/// @param field   light before the stop, shape (ny, nx) [√(W/m²)]
/// @param filter  pass band [1/m]
/// @return        field on the same grid and plane, without `filter`
/// @throws Error  if a value of the filter is not finite, a half width is not above 0, or the whole band lies beyond
///                the frequencies that the samples can represent
/// Fact: `filter_power`, the fraction of the light that passes.
/// Cost: two FFTs, one copy of the field.
Field apply_order_stop(const Field& field, const SpectralFilter& filter, const Observer& observer = {});

}  // namespace holotrace
