#include "holotrace/slm/encode/iterate/processor_light.h"

#include <utility>

#include "holotrace/base/threads.h"
#include "holotrace/slm/encode/iterate/target_sums.h"

namespace holotrace {

void ProcessorLight::add(const TargetPlane& target) {
  TargetOptics optics = optics_of(lit_.panel, lit_.params);
  optics.pupil = target.pupil;
  ways_.push_back({&target, TargetPropagation(lit_.slm, lit_.wavelength, target.z, optics)});
}

void ProcessorLight::leave(const PanelDetail& detail) {
  detail_ = detail;
  Grid grid = lit_.slm.grid;
  grid.nx *= lit_.params.subpixels;
  grid.ny *= lit_.params.subpixels;
  grid.pitch /= lit_.params.subpixels;
  while (u_.size() < levels_.size()) u_.emplace_back(grid, lit_.wavelength);
  for (size_t m = 0; m < levels_.size(); ++m) lit_.panel.leave(levels_[m], u_[m], detail);
}

// Their part of the mean irradiance of all frames in a target plane, and on request the samples of each frame.
Array2D<float> ProcessorLight::mean_light(const TargetWay& way, SampleGroup group, Samples* samples) const {
  Array2D<float> light(lit_.slm.grid.ny, lit_.slm.grid.nx);
  if (has_means(group)) {
    SamplePower power;
    power.fill(light);
    for (const Field& frame : u_) {
      std::vector<Field> shown = way.propagation.to_plane(frame, group);
      for (size_t i = 0; i < power.size(); ++i) add_power(shown[i], 1 / frames(), power[i]);
      if (samples) samples->push_back(std::move(shown));
    }
    return pixel_means(power);
  }
  for (const Field& frame : u_) {
    std::vector<Field> shown = way.propagation.to_plane(frame, group);
    add_power(shown, part_of_light(group) / frames(), light);
    if (samples) samples->push_back(std::move(shown));
  }
  return light;
}

ModulusSums ProcessorLight::plane_sums(size_t plane, SampleGroup group, bool is_kept) {
  const TargetWay& way = ways_[plane];
  PlaneLight light;
  light.mean = mean_light(way, group, is_kept ? &light.samples : nullptr);
  if (others_.exchange) others_.exchange->add_up(light.mean.values.data(), light.mean.size());
  const ModulusSums sums = others_.has_targets() ? fit_sums(*way.target, light.mean) : ModulusSums();
  if (is_kept) kept_[plane] = std::move(light);
  return sums;
}

double ProcessorLight::add_gradient(size_t plane, SampleGroup group, double scale, double factor) {
  const TargetWay& way = ways_[plane];
  auto kept = kept_.extract(plane);
  auto& [mean, samples] = kept.mapped();
  const double error = others_.has_targets() ? scale * scale * leave_residual(*way.target, 1 / scale, mean) : 0;
  if (others_.exchange) others_.exchange->hand_out(mean.values.data(), mean.size());
  SamplePower of_sample;
  if (has_means(group)) of_sample = spread_to_samples(mean);
  for (size_t m = 0; m < samples.size(); ++m) {
    if (has_means(group))
      for (size_t i = 0; i < of_sample.size(); ++i) multiply(of_sample[i], samples[m][i]);
    else
      multiply(mean, samples[m]);
    const Field back = way.propagation.to_panel(samples[m], group);
    samples[m].clear();
    lit_.panel.add_slope(levels_[m], u_[m], back, -2 * scale * scale * factor * part_of_light(group) / frames(),
                         slopes_[m], detail_);
  }
  return error;
}

void ProcessorLight::add_views(const ViewTargets& views, double scale, double factor) {
  const size_t count = views.pupils.size();
  double light = 0;
  for (const Array2D<float>& amplitude : views.amplitudes)
    for (const float a : amplitude.values) light += double(a) * a;
  if (light == 0) return;
  if (!pupils_) {
    TargetOptics optics = optics_of(lit_.panel, lit_.params);
    optics.samples = PixelSamples::middle;
    pupils_.emplace(lit_.slm, lit_.wavelength, views.pupils.front(), optics);
  }
  std::vector<std::vector<Array2D<std::complex<float>>>> pictures(u_.size());
  std::vector<Array2D<float>> power(count, Array2D<float>(views.picture.ny, views.picture.nx));
  for (size_t m = 0; m < u_.size(); ++m) {
    const Field eye = pupils_->to_eye(u_[m]);
    pictures[m].resize(count);
    parallel_for(0, int64_t(count), [&](int64_t k) {
      pictures[m][size_t(k)] = take_picture(eye, views.pupils[size_t(k)], views.z, views.picture);
      add_power(pictures[m][size_t(k)].values.data(), float(1 / frames()), power[size_t(k)].values.data(),
                power[size_t(k)].size());
    });
  }
  for (size_t k = 0; k < count; ++k) {
    float* const values = power[k].values.data();
    if (others_.exchange) others_.exchange->add_up(values, power[k].size());
    if (others_.has_targets())
      take_residual(values, views.amplitudes[k].values.data(), nullptr, float(1 / scale), power[k].size());
    if (others_.exchange) others_.exchange->hand_out(values, power[k].size());
  }
  for (size_t m = 0; m < u_.size(); ++m) {
    Field eye = pupils_->dark_eye();
    parallel_for(0, int64_t(count), [&](int64_t k) {
      Array2D<std::complex<float>>& picture = pictures[m][size_t(k)];
      multiply_by_real(power[size_t(k)].values.data(), picture.values.data(), picture.size());
      add_picture_adjoint(picture, views.pupils[size_t(k)], views.z, views.picture, eye);
    });
    lit_.panel.add_slope(levels_[m], u_[m], pupils_->to_panel(eye), -2 * scale * scale * factor / (light * frames()),
                         slopes_[m], detail_);
  }
}

}  // namespace holotrace
