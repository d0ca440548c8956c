#pragma once

#include <functional>
#include <optional>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/data/rates.h"
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

/// A window on the lattice of a field's samples: its sample (0, 0) is the field's sample (down, right).
struct WindowShift {
  Grid window;
  int right = 0, down = 0;
};

/// The window of a propagation over no distance, whose samples are those of the field; nothing for other propagations.
/// @throws Error  as propagation_output does
std::optional<WindowShift> whole_shift(const Grid& grid, double wavelength, double distance,
                                       const PropagateParams& params);

// What a propagation takes, from its plan (plan_propagator).

/// Operations of the processor, without those that make the transfer function.
SummationWork propagation_work(const Propagator<float>& plan);

/// Seconds that the processor is expected to take, by that work and the rates of cost_model.h, with all of its threads.
/// The lines of a large field come from memory, for which those rates do not hold: 1.4 times as long.
double seconds_to_propagate(const Propagator<float>& plan);

/// The adjoint Tᴴ of a propagation T, ⟨Tᴴg, u⟩ = ⟨g, Tu⟩ to rounding: the conjugate transfer function, from the
/// output's window to the input's. It propagates over −distance, with the windows and the band limit of the forward
/// propagation.
///
/// If no light leaves the windows or the band, T keeps the norm and the adjoint is its inverse. In general the norm
/// does not grow, ‖T‖ ≤ 1, if |H| ≤ 1: exactly so for an angular spectrum, nearly for a Rayleigh–Sommerfeld kernel.
///
/// @throws Error  unless both windows lie on one lattice (Propagator::is_on_lattice)
template <class Real>
Propagator<Real> adjoint_of(const Propagator<Real>& propagator);

/// Multiplies the transfer function of a propagator on a lattice by one even real function of frequency per axis. The
/// frequency is in cycles per input sample, |f| ≤ 1/2. Use: filters such as the aperture of a pixel.
template <class Real>
void filter_transfer(Propagator<Real>& propagator, const std::function<double(double)>& along_x,
                     const std::function<double(double)>& along_y);

/// The largest |H| of a propagator: an upper bound of its norm.
template <class Real>
double largest_transfer(const Propagator<Real>& propagator);

}  // namespace holotrace
