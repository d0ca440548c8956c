#include "holotrace/slm/encode/iterate/processor_projection.h"

#include <utility>

#include "holotrace/base/threads.h"
#include "holotrace/slm/encode/iterate/processor_loops.h"
#include "holotrace/slm/encode/iterate/target_sums.h"

namespace holotrace {
namespace {

// Raises the asked amplitude of pixels that are too dark, and lowers that of pixels that are too bright.
void strengthen(const TargetPlane& target, const Array2D<float>& power, double scale, Array2D<float>& asked) {
  parallel_for(0, asked.ny, [&](int64_t row) {
    const int j = int(row);
    const float *a = target.amplitude.row(j), *light = power.row(j);
    float* to = asked.row(j);
    for (int i = 0; i < asked.nx; ++i) to[i] = descent_kernel::strengthened(to[i], a[i], light[i], float(scale));
  });
}

}  // namespace

ProcessorProjection::ProcessorProjection(const ProjectionSetup& setup, const Array2D<std::complex<float>>& start)
    : pixels_(setup.slm.grid), modulus_(setup.modulus()), u_(setup.slm.grid, setup.targets.front().wavelength) {
  u_.samples = start;
  give_modulus();
  planes_.reserve(setup.targets.size());
  for (const TargetPlane& target : setup.targets)
    planes_.push_back({&target,
                       setup.is_weighted() ? std::optional(target) : std::nullopt,
                       TargetPropagation(setup.slm, target.wavelength, target.z, setup.optics()),
                       {},
                       {}});
}

// Gives the pattern, of modulus 1, that of the light on the panel.
void ProcessorProjection::give_modulus() {
  if (modulus_.size() == 0) return;
  parallel_for(0, pixels_.ny,
               [&](int64_t j) { multiply_by_real(modulus_.row(int(j)), u_.samples.row(int(j)), size_t(pixels_.nx)); });
}

void ProcessorProjection::show(size_t plane) {
  Plane& there = planes_[plane];
  there.shown = there.way.to_plane(u_);
  there.light = power_of(there.shown, pixels_);
}

double ProcessorProjection::cross_sum(size_t plane) {
  return fit_sums(*planes_[plane].target, planes_[plane].light).cross;
}

double ProcessorProjection::leave_residual(size_t plane, double scale) {
  auto& [target, asked, way, shown, light] = planes_[plane];
  double error = 0;
  if (asked) {
    error = modulus_error(*target, light, scale);
    strengthen(*target, light, scale, asked->amplitude);
    holotrace::leave_residual(*asked, scale, light);
  } else {
    error = holotrace::leave_residual(*target, scale, light);
  }
  multiply(light, shown);
  return error;
}

void ProcessorProjection::add_step(size_t plane, double factor) {
  Field back = planes_[plane].way.to_panel(planes_[plane].shown);
  if (factor == 1 && step_.samples.size() == 0)
    step_ = std::move(back);
  else
    add_part(back, factor, step_);
}

void ProcessorProjection::take_step() {
  parallel_for(
      0, pixels_.ny,
      [&](int64_t j) {
        add_and_make_unit_modulus(u_.samples.row(int(j)), step_.samples.row(int(j)), size_t(pixels_.nx));
      },
      {}, 16);
  give_modulus();
  step_ = {};
}

}  // namespace holotrace
