#include "holotrace/slm/encode/iterate/colour.h"

#include <algorithm>
#include <numeric>

#include "holotrace/base/threads.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/slm/encode/iterate/target_sums.h"

namespace holotrace {
namespace {

// What the power of some samples is multiplied by to give the mean irradiance of a pixel.
double part_of_light(SampleGroup group) { return group == SampleGroup::all ? 1 : 2; }

}  // namespace

Colour::Colour(const Slm& slm, const Hologram& hologram, double wavelength, const EncodeParams& params)
    : slm_(slm), params_(params), wavelength_(wavelength), panel_(slm, hologram, wavelength, params.subpixels) {}

void Colour::add(const TargetPlane& target) {
  ways_.push_back(
      {&target, TargetPropagation(slm_, wavelength_, target.z,
                                  {.aperture = panel_.aperture(),
                                   .samples = params_.subpixels == 1 ? PixelSamples::four : PixelSamples::middle,
                                   .subpixels = params_.subpixels,
                                   .stop = stop_width(params_),
                                   .pupil = target.pupil})});
  errors_.push_back(0);
  power_ += target_power(target);
}

double Colour::error() const { return std::accumulate(errors_.begin(), errors_.end(), 0.0); }

void Colour::leave(const std::vector<Drive>& levels, const PanelDetail& detail) {
  detail_ = detail;
  Grid grid = slm_.grid;
  grid.nx *= params_.subpixels;
  grid.ny *= params_.subpixels;
  grid.pitch /= params_.subpixels;
  while (u_.size() < levels.size()) u_.emplace_back(grid, wavelength_);
  for (size_t m = 0; m < levels.size(); ++m) panel_.leave(levels[m], u_[m], detail);
}

void Colour::judge(const std::vector<Drive>& levels) {
  leave(levels);
  ModulusSums all;
  std::vector<ModulusSums> sums;
  for (const TargetWay& way : ways_) {
    sums.push_back(fit_sums(*way.target, mean_light(way, SampleGroup::all, nullptr)));
    all.cross += sums.back().cross;
    all.square += sums.back().square;
  }
  fit_scale(all, 0);
  light_ = all.square;
  for (size_t k = 0; k < ways_.size(); ++k)
    errors_[k] = target_power(*ways_[k].target) - 2 * scale_ * sums[k].cross + scale_ * scale_ * sums[k].square;
}

// The samples that an update uses. Many frames take the diagonals of the pixels in turn: the update then takes 0.6 of
// the time, and the frames lose less than 1 dB; few frames lose more.
SampleGroup Colour::group_of(uint64_t round) const {
  constexpr size_t many = 4;
  if (u_.size() < many || params_.subpixels > 1) return SampleGroup::all;
  return round % 2 == 0 ? SampleGroup::falling : SampleGroup::rising;
}

// All four samples and those of the neighbours give the mean over a pixel better than the pixel's own samples do.
bool Colour::has_pixel_means(SampleGroup group) const { return group == SampleGroup::all && params_.subpixels == 1; }

// The mean irradiance of the frames in a target plane, and on request the samples of each frame.
Array2D<float> Colour::mean_light(const TargetWay& way, SampleGroup group, Samples* samples) const {
  Array2D<float> light(slm_.grid.ny, slm_.grid.nx);
  if (has_pixel_means(group)) {
    SamplePower power;
    power.fill(light);
    for (const Field& frame : u_) {
      std::vector<Field> shown = way.propagation.to_plane(frame, group);
      for (size_t i = 0; i < power.size(); ++i) add_power(shown[i], 1 / double(u_.size()), power[i]);
      if (samples) samples->push_back(std::move(shown));
    }
    return pixel_means(power);
  }
  for (const Field& frame : u_) {
    std::vector<Field> shown = way.propagation.to_plane(frame, group);
    add_power(shown, part_of_light(group) / double(u_.size()), light);
    if (samples) samples->push_back(std::move(shown));
  }
  return light;
}

// The scale that fits the planes of the latest turns: the sums of each earlier update count `memory` times those of
// the next one, because the light in the planes grows while the frames are found.
void Colour::fit_scale(const ModulusSums& turn, double memory) {
  recent_.cross = memory * recent_.cross + turn.cross;
  recent_.square = memory * recent_.square + turn.square;
  scale_ = recent_.square > 0 && recent_.cross > 0 ? recent_.cross / recent_.square : 1;
}

void Colour::add_planes(const std::vector<size_t>& planes, uint64_t round, double factor,
                        const std::vector<Drive>& levels, std::vector<Drive>& slopes) {
  const SampleGroup group = group_of(round);
  std::vector<PlaneLight> light(planes.size());
  ModulusSums turn;
  for (size_t i = 0; i < planes.size(); ++i) {
    light[i].mean = mean_light(ways_[planes[i]], group, &light[i].samples);
    const ModulusSums sums = fit_sums(*ways_[planes[i]].target, light[i].mean);
    turn.cross += sums.cross;
    turn.square += sums.square;
  }
  // Of all planes, the sums need no others.
  fit_scale(turn, std::min(0.7, 1 - double(planes.size()) / double(ways_.size())));
  for (size_t i = 0; i < planes.size(); ++i)
    errors_[planes[i]] = add_gradient(ways_[planes[i]], group, std::move(light[i]), factor, levels, slopes);
}

// Adds the gradient of s²·Σw(A − a/s)² by the levels of each frame, times factor. Returns that sum.
double Colour::add_gradient(const TargetWay& way, SampleGroup group, PlaneLight&& light, double factor,
                            const std::vector<Drive>& levels, std::vector<Drive>& slopes) const {
  auto& [mean, samples] = light;
  const double error = scale_ * scale_ * leave_residual(*way.target, 1 / scale_, mean);
  SamplePower of_sample;
  if (has_pixel_means(group)) of_sample = spread_to_samples(mean);
  for (size_t m = 0; m < samples.size(); ++m) {
    if (has_pixel_means(group))
      for (size_t i = 0; i < of_sample.size(); ++i) multiply(of_sample[i], samples[m][i]);
    else
      multiply(mean, samples[m]);
    const Field back = way.propagation.to_panel(samples[m], group);
    samples[m].clear();
    panel_.add_slope(levels[m], u_[m], back,
                     -2 * scale_ * scale_ * factor * part_of_light(group) / double(samples.size()), slopes[m], detail_);
  }
  return error;
}

void Colour::add_views(const ViewTargets& views, double factor, const std::vector<Drive>& levels,
                       std::vector<Drive>& slopes) {
  const size_t count = views.pupils.size();
  double light = 0;
  for (const Array2D<float>& amplitude : views.amplitudes)
    for (const float a : amplitude.values) light += double(a) * a;
  if (light == 0) return;
  if (!pupils_)
    pupils_.emplace(
        slm_, wavelength_, views.pupils.front(),
        TargetOptics{.aperture = panel_.aperture(), .subpixels = params_.subpixels, .stop = stop_width(params_)});
  std::vector<std::vector<Array2D<std::complex<float>>>> pictures(u_.size());
  std::vector<Array2D<float>> power(count, Array2D<float>(views.picture.ny, views.picture.nx));
  for (size_t m = 0; m < u_.size(); ++m) {
    const Field eye = pupils_->to_eye(u_[m]);
    pictures[m].resize(count);
    parallel_for(0, int64_t(count), [&](int64_t k) {
      pictures[m][size_t(k)] = take_picture(eye, views.pupils[size_t(k)], views.z, views.picture);
      add_power(pictures[m][size_t(k)].values.data(), float(1 / double(u_.size())), power[size_t(k)].values.data(),
                power[size_t(k)].size());
    });
  }
  for (size_t k = 0; k < count; ++k)
    take_residual(power[k].values.data(), views.amplitudes[k].values.data(), nullptr, float(1 / scale_),
                  power[k].size());
  for (size_t m = 0; m < u_.size(); ++m) {
    Field eye = pupils_->dark_eye();
    parallel_for(0, int64_t(count), [&](int64_t k) {
      Array2D<std::complex<float>>& picture = pictures[m][size_t(k)];
      multiply_by_real(power[size_t(k)].values.data(), picture.values.data(), picture.size());
      add_picture_adjoint(picture, views.pupils[size_t(k)], views.z, views.picture, eye);
    });
    panel_.add_slope(levels[m], u_[m], pupils_->to_panel(eye),
                     -2 * scale_ * scale_ * factor / (light * double(u_.size())), slopes[m], detail_);
  }
}

}  // namespace holotrace
