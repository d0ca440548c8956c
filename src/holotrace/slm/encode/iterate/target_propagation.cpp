#include "holotrace/slm/encode/iterate/target_propagation.h"

#include "holotrace/slm/panel/pixel_kernel.h"
#include "holotrace/wave/propagate/adjoint.h"

namespace holotrace {

Field TargetPropagation::to_plane(const Field& panel) const { return propagate(panel, there); }
Field TargetPropagation::to_panel(const Field& plane) const { return propagate(plane, back); }

TargetPropagation make_target_propagation(const Slm& slm, double wavelength, double z, PixelAperture aperture,
                                          double stop) {
  TargetPropagation propagation;
  propagation.there = make_propagator<float>(slm.grid, wavelength, z);
  const auto passing = [&](double lit) {
    return [=](double f) {
      const double dimmed = aperture == PixelAperture::included ? aperture_spectrum(f, lit) : 1;
      return f <= stop / 2 * (1 + 1e-9) ? dimmed : 0;
    };
  };
  if (aperture == PixelAperture::included || stop < 1)
    filter_transfer<float>(propagation.there, passing(slm.lit_x()), passing(slm.lit_y()));
  propagation.back = adjoint_of(propagation.there);
  return propagation;
}

}  // namespace holotrace
