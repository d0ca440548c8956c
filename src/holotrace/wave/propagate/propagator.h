#pragma once

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/wave/propagate/propagation_axis.h"

namespace holotrace {

/// Propagation through free space between two parallel windows, prepared for any number of fields. It is a linear
/// convolution by FFT, zero-padded so that nothing wraps around, or a cyclic convolution if the window repeats.
///
/// Windows of one pitch, wherever they lie, use wave/propagate/convolve.h; all others use
/// wave/propagate/window_transform.h.
template <class Real>
struct Propagator {
  Grid input, output;
  double wavelength = 0, distance = 0;
  PropagationMethod method = PropagationMethod::automatic;  ///< the method in use, never automatic
  PropagationAxis x, y;
  int padded_nx = 0, padded_ny = 0;  ///< input samples in a period

  /// Transfer function, one row per slot of x. Its columns are the frequencies of y: on a lattice the whole period,
  /// part by part; else first … last.
  Array2D<std::complex<Real>> transfer;

  bool is_on_lattice() const { return x.is_on_lattice() && y.is_on_lattice(); }
  int transfer_rows() const { return x.slots(); }
  int transfer_columns() const { return is_on_lattice() ? y.padded : y.frequencies(); }
  double bytes() const { return double(transfer.size()) * sizeof(std::complex<Real>); }
};

/// The output window that the parameters ask for. Columns, rows or pitch of 0 mean those of the input.
/// @throws Error  for a size or pitch below 0, or a centre that is not finite
Grid propagation_output(const Grid& input, const PropagateParams& params);

/// A propagator without its transfer function: windows, axes and method.
/// @throws Error  as make_propagator does, but not for memory
template <class Real>
Propagator<Real> plan_propagator(const Grid& grid, double wavelength, double distance, const PropagateParams& params,
                                 const Observer& observer = {});

/// Prepares the propagation over `distance` [m] (either sign, or 0) of fields on `grid` to a parallel window of any
/// size, pitch and centre.
///
/// `auto` uses Rayleigh–Sommerfeld where its kernel is sampled well over both windows, z ≥ z*. Otherwise it uses the
/// angular spectrum with Matsushima's band limit, which drops only light that leaves the window. Rayleigh–Sommerfeld is
/// the direct sum Σ h(p − p′)·u(p′)·pitch² for any samples: to rounding at one pitch, to 1e-10 (float: 1e-6) at others.
/// The angular spectrum agrees with it to 1e-9 for fields that are limited in space and band.
///
/// @throws Error  for a distance that is not finite, or that no method (or not the one named) can sample, naming the
///                window or pitch needed; for a window that no light of the input's band reaches; and as
///                propagation_output does
///
/// Memory at its peak, here or in propagate, for S bytes per complex sample of Real and padded windows of X × Y samples
/// (about the sum of both sides). On a lattice: X·Y/2·S for the transfer function (twice that off the axis) and
/// max(rows)·X/2·S for the spectrum; making a Rayleigh–Sommerfeld kernel takes 16·(X/2)·(Y/2) bytes (four times off the
/// axis). Other pitches, with K frequencies in use: K_x·K_y·S, (rows in + rows out)·K_x·S and 16·K_x·K_y.
template <class Real>
Propagator<Real> make_propagator(const Grid& grid, double wavelength, double distance,
                                 const PropagateParams& params = {}, const Observer& observer = {});

/// Bytes that a propagation needs at its peak: transfer function, work space, and the field in transit; the input field
/// does not count.
double propagation_bytes(const Grid& grid, double wavelength, double distance, const PropagateParams& params,
                         size_t bytes_per_real);

/// @throws Error  if the field's grid or wavelength differs from the propagator's
template <class Real>
void check_field(const BasicField<Real>& field, const Propagator<Real>& propagator);

/// The field at the output window of the propagator.
/// @throws Error  as check_field does
template <class Real>
BasicField<Real> propagate(const BasicField<Real>& field, const Propagator<Real>& propagator,
                           const Observer& observer = {});

}  // namespace holotrace
