#pragma once

#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// A field through a propagator whose outputs lie between its inputs all alike.
///
///     out(o) = 1/XY·Σ_{k,l} H(k, l)·û(k, l)·exp(i2π(k(o + s)/X + l(o′ + s′)/Y))
///
/// The spectrum of a field padded to twice its length falls into two parts, k even and odd: the field times
/// exp(−iπn/N) is transformed to the odd one. Each part has half of the samples, none of them padding. The parts along
/// x are done one after the other, so that half of a padded row is held at a time, in blocks of few columns; along y a
/// block is transformed, multiplied and transformed back in the cache.
///
/// Tells `energy_beyond_band`, the part of the light that the band limit drops.
template <class Real>
BasicField<Real> convolve(const BasicField<Real>& field, const Propagator<Real>& propagator, const Observer& observer);

/// Bytes that convolve holds beside the field and the propagator, its result with them.
double convolution_bytes(const PropagationAxis& x, const PropagationAxis& y, size_t bytes_per_real);

}  // namespace holotrace
