#pragma once

#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// The way of light from the pixels of a panel to a plane that it is to show something in, and the adjoint way back,
/// made ready for iterations: windows as large as the panel, zero-padded.
struct TargetPropagation {
  Propagator<float> there, back;

  Field to_plane(const Field& panel) const;
  Field to_panel(const Field& plane) const;
};

/// How the aperture of the pixels is taken into account: not, or as a part of the way: the transfer function is then
/// H·w_x·sinc(w_x·p·u)·w_y·sinc(w_y·p·v), which makes of one sample per pixel what order 0 of the panel shows.
enum class PixelAperture { left_out, included };

/// @param wavelength  [m]
/// @param z           of the plane [m]: > 0 before the panel
/// @param stop        half width of a stop on the axis, as a part of 1/2p
/// @throws Error      as make_propagator does
TargetPropagation make_target_propagation(const Slm& slm, double wavelength, double z, PixelAperture aperture,
                                          double stop = 1);

}  // namespace holotrace
