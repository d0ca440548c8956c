#include "holotrace/slm/encode/iterate/processor_arrays.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/machine.h"
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
  if (has_means(group)) {  // for a judgement, which keeps no samples
    SamplePower power;
    power.fill(light);
    for (const Field& frame : u_)
      for (const SampleGroup half : {SampleGroup::falling, SampleGroup::rising}) {  // half of the memory of all
        const std::vector<Field> shown = way.propagation.to_plane(frame, half);
        const std::vector<size_t> places = samples_of(half, power.size());
        for (size_t i = 0; i < shown.size(); ++i) add_power(shown[i], 1 / frames(), power[places[i]]);
      }
    return pixel_means(power);
  }
  for (size_t m = 0; m < u_.size(); ++m) {
    std::vector<Field> shown = way.propagation.to_plane(u_[m], group);
    add_power(shown, irradiance_factor(group) / frames(), light);
    if (samples && m >= fixed_) samples->push_back(std::move(shown));
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
  for (size_t m = fixed_; m < u_.size(); ++m) {
    std::vector<Field>& of_frame = samples[m - fixed_];
    multiply(mean, of_frame);
    const Field back = way.propagation.to_panel(of_frame, group);
    of_frame.clear();
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
  for (size_t m = 0; m < u_.size(); ++m) {
    const Field eye = way.to_eye(u_[m]);
    std::vector<Array2D<std::complex<float>>> pictures(count);
    parallel_for(0, int64_t(count), [&](int64_t k) {
      Array2D<std::complex<float>>& picture = pictures[size_t(k)];
      picture = take_picture(eye, views.pupils[size_t(k)], views.z, views.picture);
      add_power(picture.values.data(), float(1 / frames()), light.mean[size_t(k)].values.data(), picture.size());
    });
    if (is_kept && m >= fixed_) light.pictures.push_back(std::move(pictures));
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
  for (size_t m = fixed_; m < u_.size(); ++m) {
    Field eye = way.dark_eye();
    auto& of_frame = pictures[m - fixed_];
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

namespace {

template <class From, class To>
void copy_values(const Array2D<From>& from, Array2D<To>& to) {
  std::copy(from.values.begin(), from.values.end(), to.values.begin());
}

}  // namespace

Drive drive_of(const Hologram& hologram) {
  Drive drive{Array2D<float>(hologram.level.ny, hologram.level.nx),
              Array2D<float>(hologram.modulus_level.ny, hologram.modulus_level.nx)};
  copy_values(hologram.level, drive.level);
  copy_values(hologram.modulus_level, drive.modulus);
  return drive;
}

ProcessorFrames::ProcessorFrames(const Slm& slm, const EncodeParams& params, const std::vector<Hologram>& frames,
                                 const OtherFrames& others, size_t fixed)
    : slm_(slm), params_(params), others_(others), fixed_(fixed) {
  for (const Hologram& frame : frames) rounded_.push_back(drive_of(frame));
}

void ProcessorFrames::prepare_steps() {
  require(!have_steps_ended_, "expected no step and no state of a descent after its end");
  if (!frames_.empty()) return;
  for (const Drive& start : rounded_) {
    frames_.push_back({start, Drive::like(start), Drive::like(start)});
    slopes_.push_back(Drive::like(start));
  }
}

std::unique_ptr<WavelengthLight> ProcessorFrames::light_of(const DrivenPanel& panel, double wavelength) {
  return std::make_unique<ProcessorLight>(PanelInLight{slm_, params_, panel, wavelength}, rounded_, slopes_, others_,
                                          fixed_);
}

void ProcessorFrames::clear_slopes() {
  prepare_steps();
  for (Drive& slope : slopes_)
    each_array(slope, [](Array2D<float>& values) { std::fill(values.values.begin(), values.values.end(), 0.0F); });
}

void ProcessorFrames::step(const DriveStep& step) {
  const auto move = [&](const AdamStep& adam, float turn, Array2D<float> Drive::*values, size_t m) {
    Frame& frame = frames_[m];
    parallel_for(
        0, (frame.drive.*values).ny,
        [&](int64_t row) {
          const int j = int(row);
          float* drive = (frame.drive.*values).row(j);
          const size_t nx = size_t((frame.drive.*values).nx);
          adam_step(adam, (slopes_[m].*values).row(j), (frame.mean.*values).row(j), (frame.square.*values).row(j),
                    drive, nx);
          settle_drive(turn, step.levels, step.hardness, drive, (rounded_[m].*values).row(j), nx);
        },
        {}, 16);
  };
  for (size_t m = fixed_; m < frames_.size(); ++m) {
    move(step.level, step.levels_per_cycle, &Drive::level, m);
    if (rounded_[m].modulus.size() > 0) move(step.modulus, 0, &Drive::modulus, m);
  }
}

void ProcessorFrames::end_steps() {
  frames_ = {};
  slopes_ = {};
  have_steps_ended_ = true;
}

void ProcessorFrames::write(std::vector<Hologram>& frames) const {
  for (size_t m = 0; m < frames.size(); ++m) {
    copy_values(rounded_[m].level, frames[m].level);
    copy_values(rounded_[m].modulus, frames[m].modulus_level);
  }
}

template <class Work>
void ProcessorFrames::each_array_of_state(const Work& work) {
  prepare_steps();
  for (size_t m = 0; m < frames_.size(); ++m)
    for (Drive* drive : {&rounded_[m], &frames_[m].drive, &frames_[m].mean, &frames_[m].square})
      each_array(*drive, work);
}

std::vector<Array2D<float>> ProcessorFrames::state() {
  std::vector<Array2D<float>> arrays;
  each_array_of_state([&](Array2D<float>& values) { arrays.push_back(values); });
  return arrays;
}

void ProcessorFrames::restore(const std::vector<Array2D<float>>& state) {
  size_t next = 0;
  each_array_of_state([&](Array2D<float>& values) { values = state[next++]; });
}

// Transfer functions and targets of the planes; drive, moments, slope, light and samples of the frames; half of the samples of one
// frame, for a judgement.
void require_memory_for_descent(size_t planes, const Slm& slm, const EncodeParams& params,
                                const std::vector<Hologram>& frames, int processes) {
  const Grid& grid = slm.grid;
  const size_t arrays = frames.front().modulation == Modulation::complex ? 2 : 1;
  const double fine = double(params.subpixels) * params.subpixels, samples = params.subpixels > 1 ? fine : 2;
  const size_t at_once = params.planes_per_update == 0 ? planes : std::min(planes, size_t(params.planes_per_update));
  const double of_plane = 4 + 16 * fine, of_frame = 20 * double(arrays) + 8 * fine + 8 * samples * double(at_once);
  require_memory(
      processes * double(grid.pixels()) * (of_plane * double(planes) + of_frame * double(frames.size()) + 16),
      fmt::format("gradient descent for {} frame(s) of {} × {} pixels and {} target plane(s){}", frames.size(), grid.nx,
                  grid.ny, planes, processes > 1 ? fmt::format(" in each of {} processes", processes) : ""));
}

}  // namespace holotrace
