#include "holotrace/slm/encode/iterate/device_projection.h"

#include <utility>

namespace holotrace {

DeviceProjection::DeviceProjection(Device& device, const ProjectionSetup& setup,
                                   const Array2D<std::complex<float>>& start)
    : device_(device), pixels_(setup.slm.grid) {
  {
    const auto lock = device_.lock();
    u_ = device_.upload(start.values, "the light of a panel");
    step_ = device_.make_buffer(u_.bytes(), "the light of a panel");
  }
  for (const TargetPlane& target : setup.targets) {
    // Before the device is locked: it runs on many threads, which may be waiting for the device.
    const TargetPropagation way(setup.slm, target.wavelength, target.z, setup.optics());
    planes_.push_back(make_plane(target, way, setup.is_weighted()));
  }
}

DeviceProjection::Plane DeviceProjection::make_plane(const TargetPlane& target, const TargetPropagation& way,
                                                     bool is_weighted) {
  const auto lock = device_.lock();
  Plane plane{DeviceTarget(device_, target.amplitude, target.weight),
              {},
              DeviceConvolution(device_, way.there(), way.shifts()),
              {},
              {}};
  if (is_weighted) plane.asked = device_.upload(target.amplitude.values, "a target plane");
  for (DeviceBuffer& samples : plane.samples) samples = device_.make_buffer(u_.bytes(), "the light of a target plane");
  plane.light = device_.make_buffer(target.amplitude.size() * sizeof(float), "the light of a target plane");
  plane.way.grow(work_);
  return plane;
}

std::vector<DisplacedSamples> DeviceProjection::samples_of(const Plane& plane) {
  std::vector<DisplacedSamples> samples;
  for (size_t i = 0; i < plane.samples.size(); ++i) samples.push_back({i, &plane.samples[i]});
  return samples;
}

void DeviceProjection::show(size_t plane) {
  const auto lock = device_.lock();
  Plane& there = planes_[plane];
  there.way.to_many(u_, samples_of(there), work_);
  for (size_t i = 0; i < there.samples.size(); ++i)
    add_power(device_, {there.samples[i], 1, i > 0, 1}, pixels_, there.light);
}

double DeviceProjection::cross_sum(size_t plane) {
  const auto lock = device_.lock();
  return fit_sums(device_, planes_[plane].target, planes_[plane].light).cross;
}

double DeviceProjection::leave_residual(size_t plane, double scale) {
  const auto lock = device_.lock();
  const Plane& there = planes_[plane];
  const double error = there.asked.bytes() > 0
                           ? leave_residual_of_asked(device_, there.target, scale, there.asked, there.light)
                           : holotrace::leave_residual(device_, there.target, scale, there.light);
  for (const DeviceBuffer& samples : there.samples) multiply_by_real(device_, there.light, samples);
  return error;
}

void DeviceProjection::add_step(size_t plane, double factor) {
  const auto lock = device_.lock();
  Plane& there = planes_[plane];
  if (factor == 1 && !has_step_) {
    there.way.to_sum(samples_of(there), step_, work_);
  } else {
    if (back_.bytes() == 0) back_ = device_.make_buffer(u_.bytes(), "the light of a panel");
    there.way.to_sum(samples_of(there), back_, work_);
    add_part(device_, back_, float(factor), has_step_, step_);
  }
  has_step_ = true;
}

void DeviceProjection::take_step() {
  const auto lock = device_.lock();
  add_and_make_unit_modulus(device_, step_, u_);
  has_step_ = false;
}

Array2D<std::complex<float>> DeviceProjection::pattern() {
  const auto lock = device_.lock();
  Array2D<std::complex<float>> pattern(pixels_.ny, pixels_.nx);
  device_.read(u_, pattern.values.data(), u_.bytes());
  return pattern;
}

}  // namespace holotrace
