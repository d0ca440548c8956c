#pragma once

#include <vector>

#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/encode/iterate/target_sums.h"
#include "support/targets.h"

namespace holotrace {

/// The loss of gradient_descent.h put together target by target and without rounding to levels: the sum over all targets
/// of Σw(s·A − a)², not divided by their power; s is the best scale of each target by itself.
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
      std::vector<Field> u(drives.size(), Field({nx * n, ny * n, slm.grid.pitch / n}, target.wavelength));
      std::vector<std::vector<Field>> shown;
      Array2D<float> light(ny, nx);
      SamplePower of_sample;
      of_sample.fill(light);
      for (size_t m = 0; m < drives.size(); ++m) {
        panel.leave(drives[m], u[m], detail);
        shown.push_back(way.to_plane(u[m]));
        for (size_t i = 0; i < shown[m].size(); ++i)
          add_power(shown[m][i], 1 / double(drives.size()), n == 1 ? of_sample[i] : light);
      }
      if (n == 1) light = pixel_means(of_sample);
      const ModulusSums sums = fit_sums(target, light);
      const double s = sums.cross / sums.square;
      sum += s * s * leave_residual(target, 1 / s, light);
      of_sample = spread_to_samples(light);
      for (size_t m = 0; slopes && m < drives.size(); ++m) {
        for (size_t i = 0; i < shown[m].size(); ++i) multiply(n == 1 ? of_sample[i] : light, shown[m][i]);
        panel.add_slope(drives[m], u[m], way.to_panel(shown[m]), -2 * s * s / double(drives.size()), (*slopes)[m],
                        detail);
      }
    }
    return sum;
  }
};

}  // namespace holotrace
