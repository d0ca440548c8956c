#include "holotrace/slm/encode/iterate/projection_arrays.h"

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

DeviceProjection::DeviceProjection(Device& device, const ProjectionSetup& setup,
                                   const Array2D<std::complex<float>>& start)
    : device_(device), pixels_(setup.slm.grid) {
  {
    const auto lock = device_.lock();
    u_ = device_.upload(start.values, "the light of a panel");
    if (const Array2D<float> modulus = setup.modulus(); modulus.size() > 0) {
      modulus_ = device_.upload(modulus.values, "the light map of a panel");
      multiply_by_real(device_, modulus_, u_);
    }
    step_ = device_.make_buffer(u_.bytes(), "the light of a panel");
  }
  for (const TargetPlane& target : setup.targets) {
    // Before the device is locked: it runs on many threads, which may be waiting for the device.
    const TargetPropagation way(setup.slm, target.wavelength, target.z, setup.optics());
    planes_.push_back(make_plane(target, way, setup.is_weighted()));
  }
  make_samples();
}

DeviceProjection::Plane DeviceProjection::make_plane(const TargetPlane& target, const TargetPropagation& way,
                                                     bool is_weighted) {
  const auto lock = device_.lock();
  Plane plane{DeviceTarget(device_, target.amplitude, target.weight),
              {},
              DeviceConvolution(device_, way.there(), way.shifts()),
              {}};
  if (is_weighted) plane.asked = device_.upload(target.amplitude.values, "a target plane");
  plane.light = device_.make_buffer(target.amplitude.size() * sizeof(float), "the light of a target plane");
  plane.way.grow(work_);
  return plane;
}

// Beside them there is what comes back, and the factors of the transforms.
void DeviceProjection::make_samples() {
  const auto lock = device_.lock();
  const double of_plane = 4 * double(u_.bytes());
  const bool has_all = double(planes_.size()) * of_plane + 2 * double(u_.bytes()) <= device_.memory_left();
  for (size_t k = 0; k < (has_all ? planes_.size() : 1); ++k)
    for (DeviceBuffer& samples : samples_.emplace_back().values)
      samples = device_.make_buffer(u_.bytes(), "the light of a target plane");
}

// The samples of a plane, which are computed unless they are there.
std::vector<DisplacedSamples> DeviceProjection::bring(size_t plane) {
  Samples& samples = samples_of(plane);
  std::vector<DisplacedSamples> displaced;
  for (size_t i = 0; i < samples.values.size(); ++i) displaced.push_back({i, &samples.values[i]});
  if (samples.plane != plane) planes_[plane].way.to_many(u_, displaced, work_);
  samples.plane = plane;
  return displaced;
}

void DeviceProjection::show(size_t plane) {
  const auto lock = device_.lock();
  samples_of(plane).plane.reset();
  const std::vector<DisplacedSamples> samples = bring(plane);
  for (size_t i = 0; i < samples.size(); ++i)
    add_power(device_, {*samples[i].samples, 1, i > 0, 1}, pixels_, planes_[plane].light);
}

double DeviceProjection::cross_sum(size_t plane) {
  const auto lock = device_.lock();
  return fit_sums(device_, planes_[plane].target, planes_[plane].light).cross;
}

double DeviceProjection::leave_residual(size_t plane, double scale) {
  const auto lock = device_.lock();
  const Plane& there = planes_[plane];
  return there.asked.bytes() > 0 ? leave_residual_of_asked(device_, there.target, scale, there.asked, there.light)
                                 : holotrace::leave_residual(device_, there.target, scale, there.light);
}

void DeviceProjection::add_step(size_t plane, double factor) {
  const auto lock = device_.lock();
  Plane& there = planes_[plane];
  const std::vector<DisplacedSamples> samples = bring(plane);
  for (const DisplacedSamples& one : samples) multiply_by_real(device_, there.light, *one.samples);
  samples_of(plane).plane.reset();
  if (factor == 1 && !has_step_) {
    there.way.to_sum(samples, step_, work_);
  } else {
    if (back_.bytes() == 0) back_ = device_.make_buffer(u_.bytes(), "the light of a panel");
    there.way.to_sum(samples, back_, work_);
    add_part(device_, back_, float(factor), has_step_, step_);
  }
  has_step_ = true;
}

void DeviceProjection::take_step() {
  const auto lock = device_.lock();
  add_and_make_unit_modulus(device_, step_, u_);
  if (modulus_.bytes() > 0) multiply_by_real(device_, modulus_, u_);
  has_step_ = false;
}

Array2D<std::complex<float>> DeviceProjection::pattern() {
  const auto lock = device_.lock();
  Array2D<std::complex<float>> pattern(pixels_.ny, pixels_.nx);
  device_.read(u_, pattern.values.data(), u_.bytes());
  return pattern;
}

}  // namespace holotrace
