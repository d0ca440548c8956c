#include "holotrace/slm/encode/iterate/gradient_descent.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "holotrace/base/error.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/encode/iterate/iteration_kernels.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/encode/iterate/target_sums.h"

namespace holotrace {
namespace {

// One wavelength: the panel in its light, and the propagations to its target planes.
struct Colour {
  DrivenPanel panel;
  std::vector<const TargetPlane*> targets;
  std::vector<TargetPropagation> propagations;
  Field u;
  double scale = 1, error = 0;  // for the latest pattern
  double light = 0;             // its light where the weight is not 0
  double power = 0;             // power of the targets

  Colour(const Slm& slm, const Hologram& hologram, double wavelength)
      : panel(slm, hologram, wavelength), u(slm.grid, wavelength) {}
};

std::vector<std::unique_ptr<Colour>> colours_of(const std::vector<TargetPlane>& targets, const Slm& slm,
                                                const Hologram& hologram) {
  std::vector<std::unique_ptr<Colour>> colours;
  for (const TargetPlane& target : targets) {
    auto found = std::find_if(colours.begin(), colours.end(),
                              [&](const auto& colour) { return colour->u.wavelength == target.wavelength; });
    if (found == colours.end())
      found = colours.insert(colours.end(), std::make_unique<Colour>(slm, hologram, target.wavelength));
    Colour& colour = **found;
    colour.targets.push_back(&target);
    colour.propagations.push_back(make_target_propagation(slm, target.wavelength, target.z, colour.panel.aperture()));
    colour.power += target_power(target);
  }
  return colours;
}

// Light of a pattern in the target planes of one colour, its scale and error; on request the gradient by u.
Field look_at(Colour& colour, const Array2D<float>& drive, bool has_gradient) {
  colour.panel.leave(drive, colour.u);
  std::vector<Field> shown;
  ModulusSums sums;
  for (size_t k = 0; k < colour.targets.size(); ++k) {
    shown.push_back(colour.propagations[k].to_plane(colour.u));
    const ModulusSums part = fit_sums(*colour.targets[k], shown.back());
    sums.cross += part.cross;
    sums.square += part.square;
  }
  colour.scale = sums.square > 0 && sums.cross > 0 ? sums.cross / sums.square : 1;
  colour.light = sums.square;
  colour.error = colour.power - colour.scale * sums.cross;
  Field gradient;
  if (!has_gradient) return gradient;
  // s²·Σw(|v| − a/s)²; its gradient is −2s² times the residual.
  colour.error = 0;
  for (size_t k = 0; k < colour.targets.size(); ++k) {
    colour.error += colour.scale * colour.scale * leave_residual(*colour.targets[k], 1 / colour.scale, shown[k]);
    Field back = colour.propagations[k].to_panel(shown[k]);
    if (colour.targets.size() == 1) return back;
    add_part(back, 1, gradient);
  }
  return gradient;
}

// PSNR over all colours that have light, each relative to its own peak.
double psnr(const std::vector<std::unique_ptr<Colour>>& colours) {
  double error = 0, weight = 0;
  for (const auto& colour : colours) {
    double peak = 0;
    for (const TargetPlane* target : colour->targets) peak = std::max(peak, target_peak(*target));
    if (peak == 0) continue;
    error += colour->error / (peak * peak);
    for (const TargetPlane* target : colour->targets) {
      for (const float w : target->weight.values) weight += double(w);
      if (target->weight.size() == 0) weight += double(target->amplitude.size());
    }
  }
  return 10 * std::log10(weight / std::max(error, 1e-30));
}

void tell_quality(const std::vector<std::unique_ptr<Colour>>& colours, const Observer& observer, Hologram& hologram) {
  double light = 0;
  for (const auto& colour : colours) {
    if (colour->u.wavelength == hologram.wavelength) hologram.illumination = colour->scale * colour->scale;
    light += colour->light / double(colour->targets.size() * colour->u.samples.size());
  }
  observer.fact("psnr_db", Fact(psnr(colours)));
  observer.fact("target_efficiency", Fact(light / double(colours.size())));
}

}  // namespace

void judge(const std::vector<TargetPlane>& targets, const Slm& slm, const Observer& observer, Hologram& hologram) {
  const std::vector<std::unique_ptr<Colour>> colours = colours_of(targets, slm, hologram);
  Array2D<float> levels(hologram.level.ny, hologram.level.nx);
  std::copy(hologram.level.values.begin(), hologram.level.values.end(), levels.values.begin());
  for (const auto& colour : colours) look_at(*colour, levels, false);
  tell_quality(colours, observer, hologram);
}

void descend(const std::vector<TargetPlane>& targets, const Slm& slm, const EncodeParams& params,
             const Observer& observer, Hologram& hologram) {
  const int iterations = iterations_of(params);
  const std::vector<std::unique_ptr<Colour>> colours = colours_of(targets, slm, hologram);
  // Each colour is weighted by its own light, so that dim colours count as much as bright ones; dark ones do not count.
  double lit = 0;
  for (const auto& colour : colours) lit += colour->power > 0;
  const auto part = [&](const Colour& colour) { return colour.power > 0 ? 1 / (colour.power * lit) : 0; };
  const auto loss = [&] {
    double sum = 0;
    for (const auto& colour : colours) sum += colour->error * part(*colour);
    return sum;
  };

  const DrivenPanel& first = colours.front()->panel;
  const float turn = colours.size() == 1 ? float(first.turn()) : 0;  // levels in a whole turn
  const double step = (params.step > 0 ? params.step : sgd_step) * first.levels_per_radian();
  constexpr double beta1 = 0.9, beta2 = 0.99;
  const int nx = hologram.level.nx, ny = hologram.level.ny;
  Array2D<float> drive(ny, nx), levels(ny, nx), slope(ny, nx), mean(ny, nx), square(ny, nx);
  std::copy(hologram.level.values.begin(), hologram.level.values.end(), drive.values.begin());
  levels.values = drive.values;
  std::vector<double> convergence;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    std::fill(slope.values.begin(), slope.values.end(), 0.0F);
    for (const auto& colour : colours) {
      if (colour->power == 0) continue;
      const Field residual = look_at(*colour, levels, true);
      colour->panel.add_slope(levels, colour->u, residual, -2 * colour->scale * colour->scale * part(*colour), slope);
    }
    convergence.push_back(loss());
    const double fall = (1 + std::cos(pi * iteration / iterations)) / 2, t = iteration + 1;
    const double correction = std::sqrt(1 - std::pow(beta2, t)) / (1 - std::pow(beta1, t));
    const AdamStep adam{float(beta1), float(beta2), float(step * fall * correction), 1e-20F};
    parallel_for(
        0, ny,
        [&](int64_t row) {
          const int j = int(row);
          adam_step(adam, slope.row(j), mean.row(j), square.row(j), drive.row(j), size_t(nx));
          settle_drive(turn, float(hologram.levels), drive.row(j), levels.row(j), size_t(nx));
        },
        {}, 16);
    observer.progress((iteration + 1.0) / iterations);
  }
  for (const auto& colour : colours) look_at(*colour, levels, false);
  convergence.push_back(loss());
  std::copy(levels.values.begin(), levels.values.end(), hologram.level.values.begin());
  observer.fact("iterations", iterations);
  observer.fact("loss_first", Fact(convergence.front()));
  observer.fact("loss_last", Fact(convergence.back()));
  observer.curve("convergence", convergence);
  tell_quality(colours, observer, hologram);
}

}  // namespace holotrace
