#pragma once

#include <vector>

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

/// One of several propagations that share transforms. Their propagators have the same windows and the same band.
template <class Real>
struct ConvolutionLink {
  const Propagator<Real>* propagator = nullptr;
  bool is_adjoint = false;  ///< the adjoint of the propagator, whose windows must be equal (wave/propagate/adjoint.h)
  /// Displacement of the output's samples, right and down [samples]; for an adjoint minus that of its input's samples.
  double shift_x = 0, shift_y = 0;
};

/// One field through several propagations: Σ of 1 + n transforms instead of 2n. A displaced window has samples between
/// those of the other windows; for a field that is limited to its band, they are exact.
template <class Real>
std::vector<BasicField<Real>> convolve_to_many(const BasicField<Real>& field,
                                               const std::vector<ConvolutionLink<Real>>& links);

/// The sum of several fields, each through its own propagation: Σᵢ Tᵢ·fieldᵢ, in n + 1 transforms.
template <class Real>
BasicField<Real> convolve_to_sum(const std::vector<const BasicField<Real>*>& fields,
                                 const std::vector<ConvolutionLink<Real>>& links);

/// Bytes that convolve needs beside the field and the propagator, including its result.
double convolution_bytes(const PropagationAxis& x, const PropagationAxis& y, size_t bytes_per_real);

}  // namespace holotrace
