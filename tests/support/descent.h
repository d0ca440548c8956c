#pragma once

#include <vector>

#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "support/targets.h"

namespace holotrace {

/// The loss of gradient_descent.h put together target by target and without rounding to levels: the sum over all targets
/// of Σw(s·A − a)², not divided by their power; s is the best scale of each target by itself. A is that at the samples of one
/// diagonal of each pixel or, with several subpixels, at all of them.
struct Descent {
  std::vector<TargetPlane> targets;  ///< each with its own wavelength
  Slm slm;
  EncodeParams params;
  Hologram hologram;
  PanelDetail detail{};

  /// @param slopes  if given, set to the gradient
  double loss(const std::vector<Drive>& drives, std::vector<Drive>* slopes) const {
    const int n = params.subpixels, nx = slm.grid.nx, ny = slm.grid.ny;
    if (slopes) slopes->assign(drives.size(), Drive::like(drives.front()));
    double sum = 0;
    for (const TargetPlane& target : targets) {
      const DrivenPanel panel(slm, hologram, target.wavelength, n);
      const TargetPropagation way(slm, target.wavelength, target.z,
                                  {.aperture = panel.aperture(),
                                   .samples = n == 1 ? PixelSamples::four : PixelSamples::middle,
                                   .subpixels = n,
                                   .stop = stop_width(params)});
      const SampleGroup group = n == 1 ? SampleGroup::falling : SampleGroup::all;
      const double part = irradiance_factor(group) / double(drives.size());
      std::vector<Field> u(drives.size(), Field({nx * n, ny * n, slm.grid.pitch / n}, target.wavelength));
      std::vector<std::vector<Field>> shown;
      Array2D<float> light(ny, nx);
      for (size_t m = 0; m < drives.size(); ++m) {
        panel.leave(drives[m], u[m], detail);
        shown.push_back(way.to_plane(u[m], group));
        for (const Field& samples : shown[m]) add_power(samples, part, light);
      }
      const ModulusSums sums = fit_sums(target, light);
      const double s = sums.cross / sums.square;
      sum += s * s * leave_residual(target, 1 / s, light);
      for (size_t m = 0; slopes && m < drives.size(); ++m) {
        for (Field& samples : shown[m]) multiply(light, samples);
        panel.add_slope(drives[m], u[m], way.to_panel(shown[m], group), -2 * s * s * part, (*slopes)[m], detail);
      }
    }
    return sum;
  }
};

}  // namespace holotrace
