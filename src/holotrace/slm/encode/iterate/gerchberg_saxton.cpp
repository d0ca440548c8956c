#include "holotrace/slm/encode/iterate/gerchberg_saxton.h"

#include <algorithm>
#include <cmath>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/iterate/iteration_kernels.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/encode/iterate/target_sums.h"

namespace holotrace {
namespace {

// Raises the wanted amplitude of pixels that are too dark, and lowers that of pixels that are too bright.
void strengthen(const TargetPlane& wanted, const Array2D<float>& power, double scale, TargetPlane& target) {
  parallel_for(0, target.amplitude.ny, [&](int64_t j) {
    const float* a = wanted.amplitude.row(int(j));
    const float* light = power.row(int(j));
    float* asked = target.amplitude.row(int(j));
    for (int i = 0; i < target.amplitude.nx; ++i) {
      const float modulus = std::sqrt(light[i]), goal = float(scale) * a[i];
      if (goal <= 0) continue;
      const float lack = std::clamp(goal / std::max(modulus, 1e-6F * goal) - 1, -1.0F, 1.0F);
      asked[i] = std::min(2 * a[i], asked[i] * (1 + 0.1F * lack));
    }
  });
}

}  // namespace

Array2D<std::complex<float>> project_in_turn(std::vector<TargetPlane> targets, Array2D<std::complex<float>> start,
                                             const Slm& slm, const EncodeParams& params, const Observer& observer) {
  const double wavelength = targets.front().wavelength;
  for (const TargetPlane& target : targets)
    require(target.wavelength == wavelength,
            "expected targets of one wavelength for Gerchberg–Saxton, got {} and {}; use sgd, or a hologram for each",
            format_length(wavelength), format_length(target.wavelength));
  const bool is_weighted = params.method == Encoding::weighted_gerchberg_saxton;
  const int iterations = iterations_of(params);
  const std::vector<TargetPlane> wanted = is_weighted ? targets : std::vector<TargetPlane>{};
  std::vector<TargetPropagation> propagations;
  propagations.reserve(targets.size());
  for (const TargetPlane& target : targets)
    propagations.emplace_back(slm, wavelength, target.z,
                              TargetOptics{.samples = PixelSamples::four, .stop = stop_width(params)});

  Field u(slm.grid, wavelength);
  u.samples = std::move(start);
  double wanted_power = 0, scale = 0;
  for (const TargetPlane& target : targets) wanted_power += target_power(target);
  std::vector<double> convergence;
  std::vector<std::vector<Field>> shown(targets.size());
  std::vector<Array2D<float>> light(targets.size());
  for (int iteration = 0; iteration <= iterations; ++iteration) {
    for (size_t k = 0; k < targets.size(); ++k) {
      shown[k] = propagations[k].to_plane(u);
      light[k] = power_of(shown[k], slm.grid);
    }
    if (iteration == 0 || is_weighted) {
      double cross = 0;
      for (size_t k = 0; k < targets.size(); ++k)
        cross += fit_sums(is_weighted ? wanted[k] : targets[k], light[k]).cross;
      scale = cross / wanted_power;
    }
    double error = 0;
    Field step;
    for (size_t k = 0; k < targets.size(); ++k) {
      if (is_weighted) {
        error += modulus_error(wanted[k], light[k], scale);
        strengthen(wanted[k], light[k], scale, targets[k]);
        leave_residual(targets[k], scale, light[k]);
      } else {
        error += leave_residual(targets[k], scale, light[k]);
      }
      if (iteration == iterations) continue;
      multiply(light[k], shown[k]);
      Field back = propagations[k].to_panel(shown[k]);
      if (targets.size() > 1)
        add_part(back, 1 / double(targets.size()), step);
      else
        step = std::move(back);
    }
    convergence.push_back(error / (scale * scale * wanted_power));
    observer.status(fmt::format("error {:.1f} dB", 10 * std::log10(std::max(convergence.back(), 1e-30))));
    if (iteration == iterations) break;
    parallel_for(
        0, slm.grid.ny,
        [&](int64_t j) {
          add_and_make_unit_modulus(u.samples.row(int(j)), step.samples.row(int(j)), size_t(slm.grid.nx));
        },
        {}, 16);
    observer.progress((iteration + 1.0) / iterations);
  }
  observer.fact("iterations", iterations);
  observer.fact("error_first", Fact(convergence.front()));
  observer.fact("error_last", Fact(convergence.back()));
  observer.curve("convergence", convergence);
  return std::move(u.samples);
}

}  // namespace holotrace
