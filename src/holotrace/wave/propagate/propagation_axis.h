#pragma once

#include <cstddef>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/propagate.h"

namespace holotrace {

/// A smooth end of a band: the factor is 1/2 at the frequency `at` and falls as the integral of a Gaussian.
struct BandEdge {
  double at = 0, deviation = 0;  ///< [1/m]; a deviation of 0 means no edge
};

/// One axis of a propagation, along the index: columns to the right, rows downward. Sample i of the input lies at
/// i·input_pitch, sample o of the output at offset + o·output_pitch. The spectrum is sampled at the frequencies
/// k/period, k = first … last; the field therefore repeats with the period.
struct PropagationAxis {
  const char* name = "x";
  int inputs = 0, outputs = 0;
  double input_pitch = 0, output_pitch = 0, offset = 0;  ///< [m]
  double wavelength = 0, z = 0;                          ///< [m], z of either sign

  int padded = 0;           ///< input samples in a period
  int first = 0, last = 0;  ///< range of frequencies in use
  bool is_even = false;     ///< whether the transfer function at −k equals that at k

  BandEdge low{}, high{};  ///< band edges of an angular spectrum to a window off the axis or of another pitch

  // On a lattice: all outputs have the same offset from an input sample, offset = shift·pitch + rest.
  int shift = 0;
  double rest = 0;  ///< |rest| ≤ pitch/2 [m]
  int parts = 1;    ///< the spectrum is split by k modulo parts; each part has transforms of padded/parts samples

  // Off a lattice, for the sampled kernel: samples in a period, and the taper beyond the offsets in use.
  int kernel_samples = 0;
  double taper = 0, edge = 0;  ///< width of the taper, and standard deviation of its Gaussian edge [m]

  double period() const { return padded * input_pitch; }
  int frequencies() const { return last - first + 1; }
  int part_length() const { return padded / parts; }
  /// The smallest and the largest offset from an input sample to an output sample [m].
  double nearest() const { return offset - (inputs - 1) * input_pitch; }
  double farthest() const { return offset + (outputs - 1) * output_pitch; }
  double middle() const { return (nearest() + farthest()) / 2; }
  /// The largest offset between the windows, in absolute value [m].
  double reach() const;
  bool is_on_lattice() const;

  /// Rows in a table of the transfer function: all frequencies, or half of them if the function is even.
  int slots() const { return is_even ? (last > -first ? last : -first) + 1 : frequencies(); }
  int slot(int k) const { return !is_even ? k - first : k < 0 ? -k : k; }
};

/// The axes of a propagation from one window to another, with only the lattice set.
PropagationAxis make_axis_x(const Grid& input, const Grid& output, double wavelength, double z);
PropagationAxis make_axis_y(const Grid& input, const Grid& output, double wavelength, double z);

/// The method that is sampled well over |z|, or the one asked for if it can be sampled.
/// @throws Error  if none can be sampled, naming the window or the pitch that is needed
PropagationMethod choose_method(const PropagationAxis& x, const PropagationAxis& y, PropagationMethod wanted,
                                const Observer& observer);

const char* method_name(PropagationMethod method);

/// Whether to sample the paraxial kernel instead of its transfer function, which is not sampled well along this axis.
bool takes_fresnel_kernel(const PropagationAxis& axis);

/// Sets the period and the range of frequencies. Angular spectrum: frequencies whose light goes from the input window
/// to the output window, Matsushima's limit for shifted windows (Opt. Express 18, 18453, 2010). Kernels: on a lattice
/// all frequencies, else those of the kernel, which has a smooth taper beyond the offsets in use.
///
/// @param is_kernel    whether the transfer function is that of a sampled kernel
/// @param edge_widths  standard deviations of a smooth edge kept on either side; the error is erfc(edge_widths/√2)
/// @throws Error       if no light of the input's band reaches the window
void set_sampling(PropagationAxis& axis, PropagationMethod method, bool is_kernel, double edge_widths);

/// As set_sampling, for a window that repeats without end.
void set_periodic_sampling(PropagationAxis& axis);

}  // namespace holotrace
