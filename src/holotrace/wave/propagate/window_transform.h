#pragma once

#include "holotrace/base/array.h"
#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// A field through a propagator to a window of any pitch, size and centre.
///
///     out(o) = 1/XY·Σ_{k,l} H(k, l)·û(k, l)·exp(i2π(k·x(o)/T_x + l·y(o′)/T_y)),   û the transform of the padded input
///
/// The sum over the frequencies in use is a matrix Fourier transform. It is done by plain transforms if the period T is
/// a whole number of output samples, otherwise by chirps (Bluestein 1970; Rabiner, Schafer & Rader 1969).
template <class Real>
BasicField<Real> transform_to_window(const BasicField<Real>& field, const Propagator<Real>& propagator,
                                     const Observer& observer);

/// The irradiance |out|² [W/m²] of transform_to_window, without holding the field.
Array2D<float> transform_to_irradiance(const Field& field, const Propagator<float>& propagator,
                                       const Observer& observer);

/// Bytes that transform_to_window needs beside the field and the propagator, including its result.
double window_transform_bytes(const PropagationAxis& x, const PropagationAxis& y, size_t bytes_per_real);

}  // namespace holotrace
