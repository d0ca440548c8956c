#pragma once

#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// A field through a propagator on a lattice: all outputs have the same offset s from an input sample.
///
///     out(o) = 1/XY·Σ_{k,l} H(k, l)·û(k, l)·exp(i2π(k(o + s)/X + l(o′ + s′)/Y))
///
/// The field padded to twice its length has a spectrum of two parts, even and odd k. The odd part is the transform of
/// the field times exp(−iπn/N). Each part has half of the samples, and none of them is padding. Along x the parts are
/// done one after the other, so only half of a padded row is held at a time, in blocks of few columns. Along y a block
/// is transformed, multiplied and transformed back while it is in the cache.
///
/// Fact: `energy_beyond_band`, the fraction of the light that the band limit drops.
template <class Real>
BasicField<Real> convolve(const BasicField<Real>& field, const Propagator<Real>& propagator, const Observer& observer);

/// Bytes that convolve needs beside the field and the propagator, including its result.
double convolution_bytes(const PropagationAxis& x, const PropagationAxis& y, size_t bytes_per_real);

}  // namespace holotrace
