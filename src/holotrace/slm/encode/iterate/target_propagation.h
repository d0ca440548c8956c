#pragma once

#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/wave/propagate/propagator.h"

namespace holotrace {

/// The propagation from the pixels of a panel to a target plane, and its adjoint, prepared for iterations. The windows
/// are as large as the panel, and zero-padded.
struct TargetPropagation {
  Propagator<float> there, back;

  Field to_plane(const Field& panel) const;
  Field to_panel(const Field& plane) const;
};

/// Whether the propagation includes the aperture of the pixels. If included, the transfer function is
/// H·w_x·sinc(w_x·p·u)·w_y·sinc(w_y·p·v); from one sample per pixel it then gives the light of the panel's order 0.
enum class PixelAperture { left_out, included };

/// @param wavelength  [m]
/// @param z           distance of the plane [m]: > 0 in front of the panel
/// @param stop        half width of a stop on the axis, as a fraction of 1/2p
/// @throws Error      as make_propagator does
TargetPropagation make_target_propagation(const Slm& slm, double wavelength, double z, PixelAperture aperture,
                                          double stop = 1);

}  // namespace holotrace
