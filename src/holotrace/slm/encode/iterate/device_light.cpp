#include "holotrace/slm/encode/iterate/device_light.h"

#include <complex>
#include <utility>

#include "holotrace/slm/encode/iterate/pupil_propagation.h"

namespace holotrace {
namespace {

using Complex = std::complex<float>;

}  // namespace

void DeviceLight::add(const TargetPlane& target) {
  TargetOptics optics = optics_of(lit_.panel, lit_.params);
  optics.pupil = target.pupil;
  // Before the device is locked: it runs on many threads, which may be waiting for the device.
  const TargetPropagation host(lit_.slm, lit_.wavelength, target.z, optics);
  const auto lock = device_.lock();
  Way way{DeviceTarget(device_, target.amplitude, target.weight),
          host.shifts(),
          {},
          DeviceConvolution(device_, host.there(), host.shifts()),
          {}};
  if (host.to_pupil()) {
    way.to_pupil.emplace(device_, *host.to_pupil());
    way.disc = device_.make_buffer(host.disc().size() * sizeof(float), "a pupil");
    device_.write(way.disc, host.disc().values.data(), way.disc.bytes());
    make(memory_.pupil, host.disc().size() * sizeof(Complex), "a pupil");
    way.to_pupil->grow(memory_.work);
  }
  way.there.grow(memory_.work);
  ways_.push_back(std::move(way));
}

// Memory of at least that size.
void DeviceLight::make(DeviceBuffer& buffer, size_t bytes, const char* what) {
  if (buffer.bytes() >= bytes) return;
  buffer = {};
  buffer = device_.make_buffer(bytes, what);
}

void DeviceLight::leave(const PanelDetail& detail) {
  const auto lock = device_.lock();
  detail_ = detail;
  memory_.u.resize(frames_.size());
  for (size_t m = 0; m < frames_.size(); ++m) {
    make(memory_.u[m], bytes_of_samples(), "the light of a panel");
    panel_.leave(frames_[m], detail, {memory_.u[m], memory_.panel});
  }
}

DevicePlaneLight DeviceLight::take_spare() {
  if (memory_.spare.empty()) return {};
  DevicePlaneLight light = std::move(memory_.spare.back());
  memory_.spare.pop_back();
  return light;
}

// The samples of a frame in a plane. A light that is not kept has those of one frame only.
std::vector<DisplacedSamples> DeviceLight::samples_for(const Way& way, SampleGroup group, size_t frame,
                                                       DevicePlaneLight& light) {
  std::vector<DisplacedSamples> samples;
  const std::vector<size_t> shifts = samples_of(group, way.shifts.size());
  if (light.samples.size() < (frame + 1) * shifts.size()) light.samples.resize((frame + 1) * shifts.size());
  for (size_t i = 0; i < shifts.size(); ++i) {
    DeviceBuffer& there = light.samples[frame * shifts.size() + i];
    make(there, bytes_of_samples(), "the light of a target plane");
    samples.push_back({shifts[i], &there});
  }
  return samples;
}

void DeviceLight::to_plane(Way& way, const DeviceBuffer& u, const std::vector<DisplacedSamples>& samples) {
  if (!way.to_pupil) return way.there.to_many(u, samples, memory_.work);
  way.to_pupil->to_many(u, {{0, &memory_.pupil}}, memory_.work);
  multiply_by_real(device_, way.disc, memory_.pupil);
  way.there.to_many(memory_.pupil, samples, memory_.work);
}

void DeviceLight::to_panel(Way& way, const std::vector<DisplacedSamples>& samples) {
  make(memory_.back, bytes_of_samples(), "the light of a panel");
  if (!way.to_pupil) return way.there.to_sum(samples, memory_.back, memory_.work);
  way.there.to_sum(samples, memory_.pupil, memory_.work);
  multiply_by_real(device_, way.disc, memory_.pupil);
  way.to_pupil->to_sum({{0, &memory_.pupil}}, memory_.back, memory_.work);
}

// Adds the power of a frame's samples: for pixel means, those of each place in a pixel; else all to the mean.
void DeviceLight::add_powers(const std::vector<DisplacedSamples>& samples, SampleGroup group, bool is_first,
                             DevicePlaneLight& light) {
  const float factor = float(part_of_light(group) / double(frames_.size()));
  for (size_t i = 0; i < samples.size(); ++i)
    if (has_means(group))
      add_power(device_, {*samples[i].samples, factor, !is_first, 1}, pixels(), memory_.power[i]);
    else
      add_power(device_, {*samples[i].samples, factor, !is_first || i > 0, lit_.params.subpixels}, pixels(),
                light.mean);
}

ModulusSums DeviceLight::plane_sums(size_t plane, SampleGroup group, bool is_kept) {
  const auto lock = device_.lock();
  Way& way = ways_[plane];
  const size_t bytes = size_t(pixels().pixels()) * sizeof(float);
  DevicePlaneLight light = take_spare();
  make(light.mean, bytes, "the light of a target plane");
  if (has_means(group))
    for (DeviceBuffer& power : memory_.power) make(power, bytes, "the light of a target plane");
  for (size_t m = 0; m < frames_.size(); ++m) {
    const std::vector<DisplacedSamples> samples = samples_for(way, group, is_kept ? m : 0, light);
    to_plane(way, memory_.u[m], samples);
    add_powers(samples, group, m == 0, light);
  }
  if (has_means(group)) pixel_means(device_, pixels(), memory_.power, light.mean);
  const ModulusSums sums = fit_sums(device_, way.target, light.mean);
  if (is_kept)
    kept_[plane] = std::move(light);
  else
    memory_.spare.push_back(std::move(light));
  return sums;
}

double DeviceLight::add_gradient(size_t plane, SampleGroup group, double scale, double factor) {
  const auto lock = device_.lock();
  Way& way = ways_[plane];
  auto kept = kept_.extract(plane);
  DevicePlaneLight& light = kept.mapped();
  const double error = scale * scale * leave_residual(device_, way.target, 1 / scale, light.mean);
  const double of_frame = -2 * scale * scale * factor * part_of_light(group) / double(frames_.size());
  for (size_t m = 0; m < frames_.size(); ++m) {
    const std::vector<DisplacedSamples> samples = samples_for(way, group, m, light);
    for (const DisplacedSamples& there : samples)
      if (has_means(group))
        multiply_by_spread(device_, pixels(), there.shift, light.mean, *there.samples);
      else
        multiply_pixels(device_, pixels(), lit_.params.subpixels, light.mean, *there.samples);
    to_panel(way, samples);
    panel_.add_slope(frames_[m], detail_, memory_.u[m], {memory_.back, memory_.panel}, of_frame);
  }
  memory_.spare.push_back(std::move(light));
  return error;
}

DeviceLight::Eyes& DeviceLight::eyes_for(const Pupil& pupil) {
  if (eyes_) return *eyes_;
  TargetOptics optics = optics_of(lit_.panel, lit_.params);
  optics.samples = PixelSamples::middle;
  const PupilPropagation host(lit_.slm, lit_.wavelength, pupil, optics);
  const auto lock = device_.lock();
  eyes_.emplace(Eyes{host.there().output, DeviceConvolution(device_, host.there()), ViewTransforms(device_)});
  eyes_->there.grow(memory_.work);
  return *eyes_;
}

void DeviceLight::add_views(const ViewTargets& views, double scale, double factor) {
  double light = 0;
  for (const Array2D<float>& amplitude : views.amplitudes)
    for (const float a : amplitude.values) light += double(a) * a;
  if (light == 0) return;
  Eyes& eyes = eyes_for(views.pupils.front());
  const auto lock = device_.lock();
  const size_t count = views.pupils.size(), frames = frames_.size(), pixels = size_t(views.picture.pixels());
  std::vector<DeviceView> there;
  std::vector<DeviceBuffer> power, pictures;  // of each view; of each frame and view
  for (size_t k = 0; k < count; ++k) {
    there.emplace_back(eyes.transforms, eyes.window, views, k);
    power.push_back(device_.make_buffer(pixels * sizeof(float), "the views"));
  }
  make(memory_.pupil, size_t(eyes.window.pixels()) * sizeof(Complex), "the light of the pupils");
  for (size_t m = 0; m < frames; ++m) {
    eyes.there.to_many(memory_.u[m], {{0, &memory_.pupil}}, memory_.work);
    for (size_t k = 0; k < count; ++k) {
      pictures.push_back(device_.make_buffer(pixels * sizeof(Complex), "the views"));
      there[k].take(eyes.transforms, memory_.pupil, pictures.back());
      add_power(device_, {pictures.back(), float(1 / double(frames)), m > 0, 1}, views.picture, power[k]);
    }
  }
  for (size_t k = 0; k < count; ++k) take_residual(device_, there[k].target(), 1 / scale, power[k]);
  make(memory_.back, bytes_of_samples(), "the light of a panel");
  for (size_t m = 0; m < frames; ++m) {
    clear(device_, memory_.pupil);
    for (size_t k = 0; k < count; ++k)
      there[k].add_adjoint(eyes.transforms, pictures[m * count + k], power[k], memory_.pupil);
    eyes.there.to_sum({{0, &memory_.pupil}}, memory_.back, memory_.work);
    panel_.add_slope(frames_[m], detail_, memory_.u[m], {memory_.back, memory_.panel},
                     -2 * scale * scale * factor / (light * double(frames)));
  }
  device_.finish();  // before the memory of the views is released
}

}  // namespace holotrace
