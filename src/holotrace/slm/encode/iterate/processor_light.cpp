#include "holotrace/slm/encode/iterate/processor_light.h"

#include <utility>

#include "holotrace/base/threads.h"
#include "holotrace/slm/encode/iterate/target_sums.h"

namespace holotrace {

void ProcessorLight::add(const TargetPlane& target) {
  ways_.push_back(
      {&target, TargetPropagation(lit_.slm, lit_.wavelength, target.z, optics_of(lit_.panel, lit_.params))});
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
    add_power(shown, irradiance_factor(group) / frames(), light);
    if (samples) samples->push_back(std::move(shown));
  }
  return light;
}

ModulusSums ProcessorLight::plane_sums(size_t plane, SampleGroup group, bool is_kept) {
  const TargetWay& way = ways_[plane];
  PlaneLight light;
  light.mean = mean_light(way, group, is_kept ? &light.samples : nullptr);
  if (others_.exchange) others_.exchange->reduce_to_first(light.mean.values.data(), light.mean.size());
  const ModulusSums sums = others_.has_targets() ? fit_sums(*way.target, light.mean) : ModulusSums();
  if (is_kept) kept_[plane] = std::move(light);
  return sums;
}

double ProcessorLight::add_gradient(size_t plane, SampleGroup group, double scale, double factor) {
  const TargetWay& way = ways_[plane];
  auto kept = kept_.extract(plane);
  auto& [mean, samples] = kept.mapped();
  const double error = others_.has_targets() ? scale * scale * leave_residual(*way.target, 1 / scale, mean) : 0;
  if (others_.exchange) others_.exchange->broadcast_from_first(mean.values.data(), mean.size());
  for (size_t m = 0; m < samples.size(); ++m) {
    multiply(mean, samples[m]);
    const Field back = way.propagation.to_panel(samples[m], group);
    samples[m].clear();
    lit_.panel.add_slope(levels_[m], u_[m], back, -2 * scale * scale * factor * irradiance_factor(group) / frames(),
                         slopes_[m], detail_);
  }
  return error;
}

ModulusSums ProcessorLight::view_sums(const ViewTargets& views, bool is_kept) {
  const PupilPropagation& way = pupils_.to(lit_.slm, lit_.wavelength, views, optics_of(lit_.panel, lit_.params));
  const size_t count = views.pupils.size();
  ViewLight light;
  light.mean.assign(count, Array2D<float>(views.picture.ny, views.picture.nx));
  light.pictures.resize(is_kept ? u_.size() : 0);
  for (size_t m = 0; m < u_.size(); ++m) {
    const Field eye = way.to_eye(u_[m]);
    std::vector<Array2D<std::complex<float>>> pictures(count);
    parallel_for(0, int64_t(count), [&](int64_t k) {
      Array2D<std::complex<float>>& picture = pictures[size_t(k)];
      picture = take_picture(eye, views.pupils[size_t(k)], views.z, views.picture);
      add_power(picture.values.data(), float(1 / frames()), light.mean[size_t(k)].values.data(), picture.size());
    });
    if (is_kept) light.pictures[m] = std::move(pictures);
  }
  ModulusSums sums;
  for (size_t k = 0; k < count; ++k) {
    if (others_.exchange) others_.exchange->reduce_to_first(light.mean[k].values.data(), light.mean[k].size());
    if (!others_.has_targets()) continue;
    const ModulusSums of_view = fit_sums(views.amplitudes[k], {}, light.mean[k]);
    sums.cross += of_view.cross;
    sums.square += of_view.square;
  }
  if (is_kept) kept_views_ = std::move(light);
  return sums;
}

double ProcessorLight::add_gradient_of_views(const ViewTargets& views, double scale, double factor) {
  const PupilPropagation& way = pupils_.to(lit_.slm, lit_.wavelength, views, optics_of(lit_.panel, lit_.params));
  const size_t count = views.pupils.size();
  auto [mean, pictures] = std::exchange(kept_views_, {});
  double error = 0;
  for (size_t k = 0; k < count; ++k) {
    if (others_.has_targets()) error += scale * scale * leave_residual(views.amplitudes[k], {}, 1 / scale, mean[k]);
    if (others_.exchange) others_.exchange->broadcast_from_first(mean[k].values.data(), mean[k].size());
  }
  for (size_t m = 0; m < u_.size(); ++m) {
    Field eye = way.dark_eye();
    auto& of_frame = pictures[m];
    auto& of_mean = mean;
    parallel_for(0, int64_t(count), [&](int64_t k) {
      Array2D<std::complex<float>>& picture = of_frame[size_t(k)];
      multiply_by_real(of_mean[size_t(k)].values.data(), picture.values.data(), picture.size());
      add_picture_adjoint(picture, views.pupils[size_t(k)], views.z, views.picture, eye);
    });
    lit_.panel.add_slope(levels_[m], u_[m], way.to_panel(eye), -2 * scale * scale * factor / frames(), slopes_[m],
                         detail_);
  }
  return error;
}

}  // namespace holotrace
