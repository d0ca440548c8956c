#include "holotrace/slm/encode/iterate/frames_light.h"

#include <algorithm>
#include <utility>

namespace holotrace {
namespace {

constexpr double float_bytes = sizeof(float);

}  // namespace

FramesLight::FramesLight(FramesOnDevice& share, const PanelInLight& panel, size_t frames, bool is_first)
    : share_(share),
      device_(share.device()),
      memory_(share.memory()),
      lit_(panel),
      panel_(device_, panel.panel),
      bytes_of_panel_(DeviceDrivenPanel::bytes_kept(device_, panel.panel)),
      frames_(frames),
      is_first_(is_first) {}

void FramesLight::add(const TargetPlane& target, const TargetPropagation& host) {
  Way way{{}, host.shifts(), DeviceConvolution(device_, host.there(), host.shifts())};
  if (is_first_) way.target.emplace(device_, target.amplitude, target.weight);
  way.there.grow(memory_.work);
  ways_.push_back(std::move(way));
  share_.needs(bytes_needed());
}

// As the functions below make it. Views are not among it: they see what is left.
LightBytes FramesLight::bytes_needed() const {
  const EncodeParams& params = lit_.params;
  const double of_samples = double(bytes_of_samples()), of_means = float_bytes * double(pixels().pixels());
  const double planes =
      double(params.planes_per_update == 0 ? ways_.size() : std::min(ways_.size(), size_t(params.planes_per_update)));
  const SampleGroup group = samples_of_update(params.subpixels, 0, false);
  const double all = double(ways_.front().shifts.size()),
               kept = double(samples_of(group, ways_.front().shifts.size()).size());
  LightBytes bytes;
  bytes.of_frame = of_samples * (1 + planes * kept);  // the light that leaves, and its samples in the planes
  // One frame's samples, all of them, for a judgement; means, and the power of the samples; what comes back.
  bytes.beside =
      of_samples * std::max(0.0, all - kept * double(share_.frames())) + of_means * (planes + 1) + of_samples;
  if (has_means(SampleGroup::all)) bytes.beside += of_means * double(memory_.power.size());
  if (share_.frames() < frames_) bytes.beside += of_means;
  bytes.beside += bytes_of_panel_;
  // Factors of the transforms, which come when these first run: of lines twice as long as the window's.
  const double lines = 2.0 * params.subpixels * (pixels().nx + pixels().ny);
  bytes.beside += double(sizeof(std::complex<float>)) * lines * double(ways_.size());
  return bytes;
}

// Memory of at least that size.
void FramesLight::make(DeviceBuffer& buffer, size_t bytes, const char* what) {
  if (buffer.bytes() >= bytes) return;
  buffer = {};
  buffer = device_.make_buffer(bytes, what);
}

void FramesLight::leave(const PanelDetail& detail) {
  detail_ = detail;
  if (share_.are_streamed()) return;
  memory_.u.resize(share_.frames());
  share_.each_frame(FrameUse::light, [&](size_t m, const DeviceFrame& frame) {
    make(memory_.u[m], bytes_of_samples(), "the light of a panel");
    panel_.leave(frame, detail, {memory_.u[m], memory_.panel});
  });
}

// The light that leaves the panel for a frame, which is there.
const DeviceBuffer& FramesLight::light_of(size_t m, const DeviceFrame& frame) {
  if (!share_.are_streamed()) return memory_.u[m];
  memory_.u.resize(1);
  make(memory_.u.front(), bytes_of_samples(), "the light of a panel");
  panel_.leave(frame, detail_, {memory_.u.front(), memory_.panel});
  return memory_.u.front();
}

DevicePlaneLight FramesLight::take_spare() {
  if (memory_.spare.empty()) return {};
  DevicePlaneLight light = std::move(memory_.spare.back());
  memory_.spare.pop_back();
  return light;
}

// The samples of a frame in a plane. A light that is not kept has those of one frame only.
std::vector<DisplacedSamples> FramesLight::samples_for(const Way& way, SampleGroup group, size_t frame,
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

void FramesLight::to_panel(Way& way, const std::vector<DisplacedSamples>& samples) {
  make(memory_.back, bytes_of_samples(), "the light of a panel");
  way.there.to_sum(samples, memory_.back, memory_.work);
}

// Adds the power of a frame's samples: for pixel means, those of each place in a pixel; else all to the mean.
void FramesLight::add_powers(const std::vector<DisplacedSamples>& samples, SampleGroup group, bool is_first,
                             DevicePlaneLight& light) {
  const float factor = float(irradiance_factor(group) / double(frames_));
  for (size_t i = 0; i < samples.size(); ++i)
    if (has_means(group))
      add_power(device_, {*samples[i].samples, factor, !is_first, 1}, pixels(), memory_.power[i]);
    else
      add_power(device_, {*samples[i].samples, factor, !is_first || i > 0, lit_.params.subpixels}, pixels(),
                light.mean);
}

void FramesLight::show(size_t plane, SampleGroup group, bool is_kept) {
  Way& way = ways_[plane];
  const size_t bytes = pixels_of_plane() * sizeof(float);
  const bool has_all_samples = is_kept && !share_.are_streamed();
  DevicePlaneLight light = take_spare();
  make(light.mean, bytes, "the light of a target plane");
  if (has_means(group))
    for (DeviceBuffer& power : memory_.power) make(power, bytes, "the light of a target plane");
  share_.each_frame(FrameUse::light, [&](size_t m, const DeviceFrame& frame) {
    const DeviceBuffer& u = light_of(m, frame);
    const std::vector<DisplacedSamples> samples = samples_for(way, group, has_all_samples ? m : 0, light);
    way.there.to_many(u, samples, memory_.work);
    add_powers(samples, group, m == 0, light);
  });
  if (has_means(group)) pixel_means(device_, pixels(), memory_.power, light.mean);
  lights_[plane] = std::move(light);
}

ModulusSums FramesLight::fit_sums(size_t plane) {
  return holotrace::fit_sums(device_, *ways_[plane].target, mean(plane));
}

double FramesLight::leave_residual(size_t plane, double scale) {
  return holotrace::leave_residual(device_, *ways_[plane].target, scale, mean(plane));
}

void FramesLight::add_slopes(size_t plane, SampleGroup group, double factor) {
  Way& way = ways_[plane];
  DevicePlaneLight& light = lights_.at(plane);
  share_.each_frame(FrameUse::slopes, [&](size_t m, const DeviceFrame& frame) {
    const bool is_streamed = share_.are_streamed();
    const DeviceBuffer& u = light_of(m, frame);
    const std::vector<DisplacedSamples> samples = samples_for(way, group, is_streamed ? 0 : m, light);
    if (is_streamed) way.there.to_many(u, samples, memory_.work);
    for (const DisplacedSamples& there : samples)
      multiply_pixels(device_, pixels(), lit_.params.subpixels, light.mean, *there.samples);
    to_panel(way, samples);
    panel_.add_slope(frame, detail_, u, {memory_.back, memory_.panel}, factor);
  });
}

void FramesLight::drop(size_t plane) {
  auto dropped = lights_.extract(plane);
  memory_.spare.push_back(std::move(dropped.mapped()));
}

FramesLight::Eyes& FramesLight::eyes_at(const PupilPropagation& way) {
  const Propagator<float>& there = way.there();
  for (Eyes& eyes : eyes_)
    if (eyes.window == there.output && eyes.z == there.distance) return eyes;
  eyes_.push_back({there.output, there.distance, DeviceConvolution(device_, there)});
  eyes_.back().there.grow(memory_.work);
  return eyes_.back();
}

// The samples of a frame stay if there is memory for those of all frames.
void FramesLight::show_views(const ViewTargets& views, const PupilPropagation& way, bool is_kept) {
  const size_t count = views.pupils.size(), pixels = size_t(views.picture.pixels());
  if (!transforms_) transforms_.emplace(device_);
  Eyes& eyes = eyes_at(way);
  make(memory_.pupil, size_t(eyes.window.pixels()) * sizeof(std::complex<float>), "the light of the pupils");
  make(memory_.back, bytes_of_samples(), "the light of a panel");
  views_.emplace(Views{&eyes, {}, {}, {}, views.picture, is_kept && !share_.are_streamed()});
  for (size_t k = 0; k < count; ++k) {
    views_->there.emplace_back(*transforms_, eyes.window, views, k);
    views_->mean.push_back(device_.make_buffer(pixels * sizeof(float), "the views"));
  }
  const double of_pictures = double(share_.frames() * count * pixels * sizeof(std::complex<float>));
  views_->are_kept = views_->are_kept && of_pictures <= device_.memory_left();
  for (size_t i = 0; i < count * (views_->are_kept ? share_.frames() : 1); ++i)
    views_->pictures.push_back(device_.make_buffer(pixels * sizeof(std::complex<float>), "the views"));
  share_.each_frame(FrameUse::light, [&](size_t m, const DeviceFrame& frame) {
    take_pictures(m, frame);
    for (size_t k = 0; k < count; ++k)
      add_power(device_, {picture_of(m, k), float(1 / double(frames_)), m > 0, 1}, views.picture, views_->mean[k]);
  });
}

const DeviceBuffer& FramesLight::picture_of(size_t m, size_t view) const {
  return views_->pictures[(views_->are_kept ? m : 0) * views_->there.size() + view];
}

void FramesLight::take_pictures(size_t m, const DeviceFrame& frame) {
  views_->eyes->there.to_many(light_of(m, frame), {{0, &memory_.pupil}}, memory_.work);
  for (size_t k = 0; k < views_->there.size(); ++k)
    views_->there[k].take(*transforms_, memory_.pupil, picture_of(m, k));
}

ModulusSums FramesLight::fit_sums_of_view(size_t view) {
  return holotrace::fit_sums(device_, views_->there[view].target(), views_->mean[view]);
}

double FramesLight::leave_residual_of_view(size_t view, double scale) {
  return holotrace::leave_residual(device_, views_->there[view].target(), scale, views_->mean[view]);
}

void FramesLight::add_slopes_of_views(double factor) {
  share_.each_frame(FrameUse::slopes, [&](size_t m, const DeviceFrame& frame) {
    if (!views_->are_kept) take_pictures(m, frame);
    clear(device_, memory_.pupil);
    for (size_t k = 0; k < views_->there.size(); ++k)
      views_->there[k].add_adjoint(*transforms_, picture_of(m, k), views_->mean[k], memory_.pupil);
    views_->eyes->there.to_sum({{0, &memory_.pupil}}, memory_.back, memory_.work);
    // Of frames that come and go, the light is that of the frame that is there: take_pictures has made it.
    panel_.add_slope(frame, detail_, memory_.u[share_.are_streamed() ? 0 : m], {memory_.back, memory_.panel}, factor);
  });
}

void FramesLight::drop_views() {
  device_.finish();  // before the memory of the views is released
  views_.reset();
}

}  // namespace holotrace
