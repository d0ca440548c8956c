#include "holotrace/slm/encode/iterate/gerchberg_saxton.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/iterate/iteration_devices.h"
#include "holotrace/slm/encode/iterate/projection_arrays.h"
#include "holotrace/slm/encode/iterate/target_sums.h"

namespace holotrace {

Array2D<float> ProjectionSetup::modulus() const {
  if (!slm.effects.light_map) return {};
  Array2D<float> modulus = *slm.effects.light_map;
  for (float& value : modulus.values) value = std::sqrt(value);
  return modulus;
}

namespace {

using ComplexPattern = Array2D<std::complex<float>>;

// A pattern that is moved toward the targets' moduli, and the scale of its light.
class Projections {
 public:
  Projections(const ProjectionSetup& setup, std::unique_ptr<ProjectionArrays> arrays)
      : arrays_(std::move(arrays)), planes_(setup.targets.size()), is_weighted_(setup.is_weighted()) {
    for (const TargetPlane& target : setup.targets) wanted_power_ += target_power(target);
  }

  // The error of the pattern of now, as a fraction of the targets' light. Afterwards the planes have their residuals.
  double project() {
    for (size_t k = 0; k < planes_; ++k) arrays_->show(k);
    if (scale_ == 0 || is_weighted_) fit_scale();
    double error = 0;
    for (size_t k = 0; k < planes_; ++k) error += arrays_->leave_residual(k, scale_);
    return error / (scale_ * scale_ * wanted_power_);
  }

  void step() {
    for (size_t k = 0; k < planes_; ++k) arrays_->add_step(k, 1 / double(planes_));
    arrays_->take_step();
  }

  ComplexPattern pattern() { return arrays_->pattern(); }

 private:
  void fit_scale() {
    double cross = 0;
    for (size_t k = 0; k < planes_; ++k) cross += arrays_->cross_sum(k);
    scale_ = cross / wanted_power_;
  }

  std::unique_ptr<ProjectionArrays> arrays_;
  size_t planes_;
  bool is_weighted_;
  double wanted_power_ = 0, scale_ = 0;  // no scale: not fitted yet
};

std::unique_ptr<ProjectionArrays> arrays_on(Device* device, const ProjectionSetup& setup, const ComplexPattern& start) {
  if (device) return std::make_unique<DeviceProjection>(*device, setup, start);
  return std::make_unique<ProcessorProjection>(setup, start);
}

ProjectedPattern project_on(const IterationDevices& place, const ProjectionSetup& setup, const ComplexPattern& start,
                            const Observer& observer) {
  const int iterations = iterations_of(setup.params);
  const auto projections =
      place.compute([&] { return std::make_unique<Projections>(setup, arrays_on(place.device(), setup, start)); });
  std::vector<double> convergence;
  for (int iteration = 0; iteration <= iterations; ++iteration) {
    convergence.push_back(place.compute([&] {
      if (iteration > 0) projections->step();
      return projections->project();
    }));
    observer.status(fmt::format("error {:.1f} dB", 10 * std::log10(std::max(convergence.back(), 1e-30))));
    if (iteration > 0) observer.progress(double(iteration) / iterations);
  }
  ProjectedPattern found{place.compute([&] { return projections->pattern(); }), place.device()};
  observer.fact("iterations", iterations);
  tell_devices(place.devices, observer);
  observer.fact("error_first", Fact(convergence.front()));
  observer.fact("error_last", Fact(convergence.back()));
  observer.curve("convergence", convergence);
  return found;
}

}  // namespace

ProjectedPattern project_in_turn(const std::vector<TargetPlane>& targets, const ComplexPattern& start, const Slm& slm,
                                 const EncodeParams& params, const Observer& observer) {
  const double wavelength = targets.front().wavelength;
  for (const TargetPlane& target : targets)
    require(target.wavelength == wavelength,
            "expected targets of one wavelength for Gerchberg–Saxton, got {} and {}; use sgd, or a hologram for each",
            format_length(wavelength), format_length(target.wavelength));
  const ProjectionSetup setup{targets, slm, params};
  Device* const device = device_for_projections(targets, {slm, params});
  return on_devices_or_processor(
      device ? std::vector{device} : std::vector<Device*>(), params.device, observer,
      [&](const IterationDevices& place) { return project_on(place, setup, start, observer); });
}

}  // namespace holotrace
