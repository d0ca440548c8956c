#pragma once

#include <cstddef>

#include "holotrace/base/observer.h"
#include "holotrace/data/grid.h"
#include "holotrace/data/params/propagate.h"

namespace holotrace {

/// A smooth end of a band: half at the frequency `at`, its fall that of a Gaussian's integral.
struct BandEdge {
  double at = 0, deviation = 0;  ///< [1/m]; no edge where the deviation is 0
};

/// One axis of a propagation, along the index: columns to the right, rows downward. Sample i of the input lies at
/// i·input_pitch, sample o of the output at offset + o·output_pitch; the spectrum is sampled at the frequencies
/// k/period, k = first … last, which makes the field repeat with the period.
struct PropagationAxis {
  const char* name = "x";
  int inputs = 0, outputs = 0;
  double input_pitch = 0, output_pitch = 0, offset = 0;  ///< [m]
  double wavelength = 0, z = 0;                          ///< [m], z of either sign

  int padded = 0;           ///< input samples in a period
  int first = 0, last = 0;  ///< frequencies held
  bool is_even = false;     ///< the transfer function at −k is that at k

  BandEdge low{}, high{};  ///< of an angular spectrum to a window off the axis or of another pitch

  // On a lattice, where the outputs lie between the inputs all alike: offset = shift·pitch + rest.
  int shift = 0;
  double rest = 0;  ///< |rest| ≤ pitch/2 [m]
  int parts = 1;    ///< the spectrum is taken apart by k modulo parts, each with transforms of padded/parts samples

  // Elsewhere, of the sampled kernel: samples in a period, and the taper beyond the offsets that count.
  int kernel_samples = 0;
  double taper = 0, edge = 0;  ///< its width, and the standard deviation of its Gaussian edge [m]

  double period() const { return padded * input_pitch; }
  int frequencies() const { return last - first + 1; }
  int part_length() const { return padded / parts; }
  /// Offsets from an input sample to an output sample, the least and the greatest [m].
  double nearest() const { return offset - (inputs - 1) * input_pitch; }
  double farthest() const { return offset + (outputs - 1) * output_pitch; }
  double middle() const { return (nearest() + farthest()) / 2; }
  /// The largest offset between the windows, either way [m].
  double reach() const;
  bool is_on_lattice() const;

  /// Rows of a table of the transfer function: frequencies, or half of them if it is even.
  int slots() const { return is_even ? (last > -first ? last : -first) + 1 : frequencies(); }
  int slot(int k) const { return !is_even ? k - first : k < 0 ? -k : k; }
};

/// The two axes of a propagation from one window to another, their lattice set and nothing else.
PropagationAxis make_axis_x(const Grid& input, const Grid& output, double wavelength, double z);
PropagationAxis make_axis_y(const Grid& input, const Grid& output, double wavelength, double z);

/// The way that is sampled well over |z|, or the one asked for if that can be sampled.
/// @throws Error naming the window or the pitch that would do
PropagationMethod choose_method(const PropagationAxis& x, const PropagationAxis& y, PropagationMethod wanted,
                                const Observer& observer);

const char* method_name(PropagationMethod method);

/// Whether the paraxial kernel, and not its transfer function, is sampled well along this axis.
bool takes_fresnel_kernel(const PropagationAxis& axis);

/// Sets the period and the frequencies held. Angular spectrum: those whose light goes from the input's window to the
/// output's, Matsushima's limit for shifted windows (Opt. Express 18, 18453, 2010). Kernels: on a lattice all;
/// elsewhere those of the kernel, tapered beyond the offsets that count by a smoothed edge.
///
/// @param is_kernel    the transfer function is that of a sampled kernel
/// @param edge_widths  standard deviations of a smooth edge on either side: its error is erfc(edge_widths/√2)
/// @throws Error       where no light of the input's band reaches the window
void set_sampling(PropagationAxis& axis, PropagationMethod method, bool is_kernel, double edge_widths);

/// As set_sampling, for a window that repeats for ever.
void set_periodic_sampling(PropagationAxis& axis);

}  // namespace holotrace
