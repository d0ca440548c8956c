#pragma once

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params.h"

namespace holotrace {

/// Free space between two parallel windows, made ready for any number of fields: a linear convolution
/// by FFT, zero-padded so that nothing wraps around; or, where the window repeats, the cyclic one.
template <class Real>
struct Propagator {
  Grid input, output;  ///< of one pitch, both centred on the axis
  double wavelength = 0, distance = 0;
  PropagationMethod method = PropagationMethod::automatic;  ///< the one in use, never automatic
  int padded_nx = 0, padded_ny = 0;

  /// Transfer function at the frequencies k/(padded·pitch), k = 0 … padded/2. It is even in u and in v,
  /// so a quarter holds it all.
  Array2D<std::complex<Real>> transfer;

  /// First frequency index per axis beyond the band that the method holds; padded/2 + 1 if all is held.
  int band_nx = 0, band_ny = 0;
};

/// The window that the parameters ask for, on the same pitch and axis as the input's.
/// @throws Error  for a size below 0, or one that differs from the input's by an odd number of pixels
Grid propagation_output(const Grid& input, const PropagateParams& params);

/// Prepares the propagation over `distance` [m] (either sign) of fields on `grid`.
///
/// `auto` takes Rayleigh–Sommerfeld where its kernel is sampled well over the whole window, z ≥ z*, and
/// else the angular spectrum with Matsushima's band limit, whose loss leaves the window anyway.
///
/// @throws Error  for a distance that is not finite, or that no method (or not the one named) can
///                sample, naming the window or pitch needed; and for an output window whose size
///                differs from the input's by an odd number of pixels
template <class Real>
Propagator<Real> make_propagator(const Grid& grid, double wavelength, double distance,
                                 const PropagateParams& params = {}, const Observer& observer = {});

/// The field at the other end of the propagator.
/// @throws Error  if the field's grid or wavelength is not the propagator's
///
/// Cost: pruned transforms: only rows that hold input or output are transformed along x.
template <class Real>
BasicField<Real> propagate(const BasicField<Real>& field, const Propagator<Real>& propagator,
                           const Observer& observer = {});

}  // namespace holotrace
