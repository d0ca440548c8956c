#include "holotrace/slm/plane_optics.h"

#include "holotrace/slm/pixel_kernel.h"
#include "holotrace/wave/adjoint.h"

namespace holotrace {

Field PlaneOptics::to_plane(const Field& panel) const { return propagate(panel, there); }
Field PlaneOptics::to_panel(const Field& plane) const { return propagate(plane, back); }

PlaneOptics make_plane_optics(const Slm& slm, double wavelength, double z, PixelAperture aperture) {
  PlaneOptics optics;
  optics.there = make_propagator<float>(slm.grid, wavelength, z);
  if (aperture == PixelAperture::included) {
    const double across = slm.lit_x(), down = slm.lit_y();
    filter_transfer<float>(
        optics.there, [&](double f) { return aperture_spectrum(f, across); },
        [&](double f) { return aperture_spectrum(f, down); });
  }
  optics.back = adjoint_of(optics.there);
  return optics;
}

}  // namespace holotrace
