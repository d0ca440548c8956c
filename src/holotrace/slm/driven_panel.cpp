#include "holotrace/slm/driven_panel.h"

#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/iteration_arrays.h"
#include "holotrace/slm/phasors.h"

namespace holotrace {

DrivenPanel::DrivenPanel(const Slm& slm, const Hologram& hologram, double wavelength) {
  const double design = slm.design_wavelength > 0 ? slm.design_wavelength : hologram.wavelength;
  cycles_per_level_ = slm.phase_range / (2 * pi) * design / wavelength / hologram.levels;
}

PixelAperture DrivenPanel::aperture() const { return PixelAperture::included; }

void DrivenPanel::leave(const Array2D<float>& drive, Field& u) const {
  parallel_for(
      0, drive.ny,
      [&](int64_t j) {
        AlignedVector<float> cycles(size_t(drive.nx));
        const float* level = drive.row(int(j));
        for (size_t i = 0; i < cycles.size(); ++i) cycles[i] = float(cycles_per_level_) * level[i];
        phasors(cycles.data(), nullptr, cycles.size(), u.samples.row(int(j)));
      },
      {}, 16);
}

void DrivenPanel::add_slope(const Array2D<float>& drive, const Field& u, const Field& g, double factor,
                            Array2D<float>& slope) const {
  const float radians_per_level = float(factor * 2 * pi * cycles_per_level_);
  parallel_for(
      0, drive.ny,
      [&](int64_t j) {
        add_phase_gradient(g.samples.row(int(j)), u.samples.row(int(j)), radians_per_level, slope.row(int(j)),
                           size_t(drive.nx));
      },
      {}, 16);
}

}  // namespace holotrace
