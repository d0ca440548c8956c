#include "holotrace/slm/encode/iterate/gradient_descent.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/encode/iterate/iteration_kernels.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/slm/encode/iterate/pupil_propagation.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/slm/encode/iterate/target_sums.h"

namespace holotrace {
namespace {

// What is known of a plane since its last turn.
struct PlaneLight {
  ModulusSums sums;
  double error = 0;
};

// What the power of some samples is multiplied by to give the mean irradiance of a pixel.
double part_of_light(SampleGroup group) { return group == SampleGroup::all ? 1 : 2; }

// A target and the way to it.
struct TargetWay {
  const TargetPlane* target;
  TargetPropagation propagation;
};

Array2D<float> levels_of(const Hologram& hologram) {
  Array2D<float> levels(hologram.level.ny, hologram.level.nx);
  std::copy(hologram.level.values.begin(), hologram.level.values.end(), levels.values.begin());
  return levels;
}

// One wavelength: the panel in its light, and the propagations to its target planes.
class Colour {
 public:
  Colour(const Slm& slm, const Hologram& hologram, double wavelength, const EncodeParams& params)
      : wavelength(wavelength), slm_(slm), params_(params), panel(slm, hologram, wavelength, params.subpixels) {}

  void add(const TargetPlane& target) {
    ways.push_back(way_to(target));
    lights.emplace_back();
    power += target_power(target);
  }

  TargetWay way_to(const TargetPlane& target) const {
    return {&target, TargetPropagation(slm_, wavelength, target.z,
                                       {.aperture = panel.aperture(),
                                        .samples = params_.subpixels == 1 ? PixelSamples::four : PixelSamples::middle,
                                        .subpixels = params_.subpixels,
                                        .stop = stop_width(params_),
                                        .pupil = target.pupil})};
  }

  // Light of all frames on the panel.
  void leave(const std::vector<Array2D<float>>& levels) {
    Grid grid = slm_.grid;
    grid.nx *= params_.subpixels;
    grid.ny *= params_.subpixels;
    grid.pitch /= params_.subpixels;
    while (u.size() < levels.size()) u.emplace_back(grid, wavelength);
    for (size_t m = 0; m < levels.size(); ++m) panel.leave(levels[m], u[m]);
  }

  // The samples that an update uses. Many frames take the diagonals of the pixels in turn: the update then takes 0.6 of
  // the time, and the frames lose less than 1 dB; few frames lose more.
  SampleGroup group_of(uint64_t round) const {
    constexpr size_t many = 4;
    if (u.size() < many || params_.subpixels > 1) return SampleGroup::all;
    return round % 2 == 0 ? SampleGroup::falling : SampleGroup::rising;
  }

  // The mean irradiance of the frames in a target plane, and on request the samples of each frame.
  Array2D<float> mean_light(const TargetWay& way, SampleGroup group, std::vector<std::vector<Field>>* samples) const {
    Array2D<float> light(slm_.grid.ny, slm_.grid.nx);
    for (const Field& frame : u) {
      std::vector<Field> shown = way.propagation.to_plane(frame, group);
      add_power(shown, part_of_light(group) / double(u.size()), light);
      if (samples) samples->push_back(std::move(shown));
    }
    return light;
  }

  // The scale that fits the planes of the latest turns: the sums of each earlier update count `memory` times those of
  // the next one, because the light in the planes grows while the frames are found.
  void fit_scale(const ModulusSums& turn, double memory) {
    recent_.cross = memory * recent_.cross + turn.cross;
    recent_.square = memory * recent_.square + turn.square;
    scale = recent_.square > 0 && recent_.cross > 0 ? recent_.cross / recent_.square : 1;
  }

  // Adds the gradient of s²·Σw(A − a/s)² by the levels of each frame, times factor. Returns that sum.
  double add_gradient(const TargetWay& way, SampleGroup group, Array2D<float> light,
                      std::vector<std::vector<Field>>& samples, double factor,
                      const std::vector<Array2D<float>>& levels, std::vector<Array2D<float>>& slopes) const {
    const double error = scale * scale * leave_residual(*way.target, 1 / scale, light);
    for (size_t m = 0; m < samples.size(); ++m) {
      multiply(light, samples[m]);
      const Field back = way.propagation.to_panel(samples[m], group);
      samples[m].clear();
      panel.add_slope(levels[m], u[m], back,
                      -2 * scale * scale * factor * part_of_light(group) / double(samples.size()), slopes[m]);
    }
    return error;
  }

  // Adds the gradient of the error of some views, at the scale of the planes, as a fraction of their light. Returns that
  // fraction.
  double add_views(const ViewTargets& views, double factor, const std::vector<Array2D<float>>& levels,
                   std::vector<Array2D<float>>& slopes) {
    const size_t count = views.pupils.size();
    double light = 0;
    for (const Array2D<float>& amplitude : views.amplitudes)
      for (const float a : amplitude.values) light += double(a) * a;
    if (light == 0) return 0;
    if (!pupils_)
      pupils_.emplace(
          slm_, wavelength, views.pupils.front().centre.z,
          TargetOptics{.aperture = panel.aperture(), .subpixels = params_.subpixels, .stop = stop_width(params_)});
    std::vector<std::vector<Array2D<std::complex<float>>>> pictures(u.size());
    std::vector<Array2D<float>> power(count, Array2D<float>(views.picture.ny, views.picture.nx));
    for (size_t m = 0; m < u.size(); ++m) {
      const Field eye = pupils_->to_eye(u[m]);
      pictures[m].resize(count);
      parallel_for(0, int64_t(count), [&](int64_t k) {
        pictures[m][size_t(k)] = take_picture(eye, views.pupils[size_t(k)], views.z, views.picture);
        add_power(pictures[m][size_t(k)].values.data(), float(1 / double(u.size())), power[size_t(k)].values.data(),
                  power[size_t(k)].size());
      });
    }
    double error = 0;
    for (size_t k = 0; k < count; ++k)
      error += take_residual(power[k].values.data(), views.amplitudes[k].values.data(), nullptr, float(1 / scale),
                             power[k].size());
    for (size_t m = 0; m < u.size(); ++m) {
      Field eye = pupils_->dark_eye();
      parallel_for(0, int64_t(count), [&](int64_t k) {
        Array2D<std::complex<float>>& picture = pictures[m][size_t(k)];
        multiply_by_real(power[size_t(k)].values.data(), picture.values.data(), picture.size());
        add_picture_adjoint(picture, views.pupils[size_t(k)], views.z, views.picture, eye);
      });
      panel.add_slope(levels[m], u[m], pupils_->to_panel(eye), -2 * scale * scale * factor / (light * double(u.size())),
                      slopes[m]);
    }
    return error * scale * scale / light;
  }

  // Error and sums of all planes for some levels.
  void judge(const std::vector<Array2D<float>>& levels) {
    leave(levels);
    ModulusSums all;
    for (size_t k = 0; k < ways.size(); ++k) {
      lights[k].sums = fit_sums(*ways[k].target, mean_light(ways[k], SampleGroup::all, nullptr));
      all.cross += lights[k].sums.cross;
      all.square += lights[k].sums.square;
    }
    fit_scale(all, 0);
    for (size_t k = 0; k < ways.size(); ++k)
      lights[k].error =
          target_power(*ways[k].target) - 2 * scale * lights[k].sums.cross + scale * scale * lights[k].sums.square;
  }

  double error() const {
    return std::accumulate(lights.begin(), lights.end(), 0.0,
                           [](double sum, const PlaneLight& light) { return sum + light.error; });
  }

  double light() const {
    return std::accumulate(lights.begin(), lights.end(), 0.0,
                           [](double sum, const PlaneLight& light) { return sum + light.sums.square; });
  }

  double wavelength;

 private:
  const Slm& slm_;
  const EncodeParams& params_;
  ModulusSums recent_;
  std::optional<PupilPropagation> pupils_;  // made for the first views

 public:
  DrivenPanel panel;
  std::vector<TargetWay> ways;
  std::vector<PlaneLight> lights;  // of each plane, from its last turn
  std::vector<Field> u;            // light that leaves the panel, of each frame
  double scale = 1;
  double power = 0;  // power of the targets
};

using Colours = std::vector<std::unique_ptr<Colour>>;

Colours colours_of(const std::vector<TargetPlane>& targets, const Slm& slm, const EncodeParams& params,
                   const Hologram& hologram) {
  Colours colours;
  for (const TargetPlane& target : targets) {
    auto found = std::find_if(colours.begin(), colours.end(),
                              [&](const auto& colour) { return colour->wavelength == target.wavelength; });
    if (found == colours.end())
      found = colours.insert(colours.end(), std::make_unique<Colour>(slm, hologram, target.wavelength, params));
    (*found)->add(target);
  }
  return colours;
}

// PSNR over all colours that have light, each relative to its own peak.
double psnr(const Colours& colours) {
  double error = 0, weight = 0;
  for (const auto& colour : colours) {
    double peak = 0;
    for (const TargetWay& way : colour->ways) peak = std::max(peak, target_peak(*way.target));
    if (peak == 0) continue;
    error += colour->error() / (peak * peak);
    for (const TargetWay& way : colour->ways) {
      for (const float w : way.target->weight.values) weight += double(w);
      if (way.target->weight.size() == 0) weight += double(way.target->amplitude.size());
    }
  }
  return 10 * std::log10(weight / std::max(error, 1e-30));
}

void tell_quality(const Colours& colours, const Observer& observer, std::vector<Hologram>& frames) {
  double light = 0;
  for (const auto& colour : colours) {
    for (Hologram& frame : frames)
      if (colour->wavelength == frame.wavelength) frame.illumination = colour->scale * colour->scale;
    light += colour->light() / (double(colour->ways.size()) * double(frames.front().grid.pixels()));
  }
  observer.fact("psnr_db", Fact(psnr(colours)));
  observer.fact("target_efficiency", Fact(light / double(colours.size())));
}

// The planes of each iteration: all of them have their turn, in an order that is random for each round.
class Turns {
 public:
  Turns(size_t planes, int per_update, uint64_t seed)
      : order_(planes), per_update_(per_update == 0 ? planes : std::min(planes, size_t(per_update))), seed_(seed) {
    std::iota(order_.begin(), order_.end(), size_t(0));
    next_ = planes;
  }

  // Number of rounds that have begun.
  uint64_t round() const { return round_; }

  std::vector<size_t> take() {
    std::vector<size_t> planes;
    if (per_update_ == order_.size()) {
      ++round_;
      return order_;
    }
    while (planes.size() < per_update_) {
      if (next_ == order_.size()) shuffle();
      planes.push_back(order_[next_++]);
    }
    return planes;
  }

 private:
  void shuffle() {
    CounterRandom random(seed_, 0, round_++);
    for (size_t i = order_.size(); i > 1; --i) std::swap(order_[i - 1], order_[size_t(random.uniform() * double(i))]);
    next_ = 0;
  }

  std::vector<size_t> order_;
  size_t per_update_, next_;
  uint64_t seed_, round_ = 0;
};

// Transfer functions and targets of the planes; drive, moments, slope, light and samples of the frames.
void require_memory_for(size_t planes, size_t frames, const Grid& grid, const EncodeParams& params) {
  const double fine = double(params.subpixels) * params.subpixels, samples = params.subpixels > 1 ? fine : 4;
  const double of_plane = 4 + 16 * fine, of_frame = 20 + 8 * fine + 8 * samples;
  require_memory(double(grid.pixels()) * (of_plane * double(planes) + of_frame * double(frames)),
                 fmt::format("gradient descent for {} frame(s) of {} × {} pixels and {} target plane(s)", frames,
                             grid.nx, grid.ny, planes));
}

// Drive of a frame, and what Adam remembers of it.
struct Drive {
  Array2D<float> level, mean, square;
};

}  // namespace

void judge(const std::vector<TargetPlane>& targets, const Slm& slm, const EncodeParams& params,
           const Observer& observer, std::vector<Hologram>& frames) {
  const Colours colours = colours_of(targets, slm, params, frames.front());
  std::vector<Array2D<float>> levels;
  for (const Hologram& frame : frames) levels.push_back(levels_of(frame));
  for (const auto& colour : colours) colour->judge(levels);
  tell_quality(colours, observer, frames);
}

void descend(const TargetSet& targets, const Slm& slm, const EncodeParams& params, const Observer& observer,
             std::vector<Hologram>& frames) {
  const int iterations = iterations_of(params);
  require_memory_for(targets.planes.size(), frames.size(), slm.grid, params);
  const Colours colours = colours_of(targets.planes, slm, params, frames.front());
  // Each colour is weighted by its own light, so that dim colours count as much as bright ones; dark ones do not count.
  double lit = 0;
  for (const auto& colour : colours) lit += colour->power > 0;
  const auto part = [&](const Colour& colour) { return colour.power > 0 ? 1 / (colour.power * lit) : 0; };
  const auto loss = [&] {
    double sum = 0;
    for (const auto& colour : colours) sum += colour->error() * part(*colour);
    return sum;
  };

  const DrivenPanel& first = colours.front()->panel;
  const float turn = colours.size() == 1 ? float(first.turn()) : 0;  // levels in a whole turn
  const double step = (params.step > 0 ? params.step : sgd_step) * first.levels_per_radian();
  constexpr double beta1 = 0.9, beta2 = 0.99;
  const int nx = slm.grid.nx, ny = slm.grid.ny;
  std::vector<Drive> drives;
  std::vector<Array2D<float>> levels, slopes;
  for (const Hologram& frame : frames) {
    levels.push_back(levels_of(frame));
    drives.push_back({levels.back(), Array2D<float>(ny, nx), Array2D<float>(ny, nx)});
    slopes.emplace_back(ny, nx);
  }
  std::vector<Turns> turns;
  for (const auto& colour : colours)
    turns.emplace_back(colour->ways.size(), params.planes_per_update, uint64_t(params.seed));
  if (iterations > 0)
    for (const auto& colour : colours) colour->judge(levels);  // planes count from the start, before their first turn
  std::vector<double> convergence;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    for (Array2D<float>& slope : slopes) std::fill(slope.values.begin(), slope.values.end(), 0.0F);
    const bool is_view = targets.draw_views && iteration % 2 == 1;
    for (size_t c = 0; c < colours.size(); ++c) {
      Colour& colour = *colours[c];
      if (colour.power == 0) continue;
      colour.leave(levels);
      if (is_view) {
        colour.add_views(targets.draw_views(iteration, colour.wavelength), 1 / lit, levels, slopes);
        continue;
      }
      const std::vector<size_t> planes = turns[c].take();
      const SampleGroup group = colour.group_of(turns[c].round());
      std::vector<Array2D<float>> light;
      std::vector<std::vector<std::vector<Field>>> samples(planes.size());
      ModulusSums turn_sums;
      for (size_t i = 0; i < planes.size(); ++i) {
        light.push_back(colour.mean_light(colour.ways[planes[i]], group, &samples[i]));
        const ModulusSums sums = fit_sums(*colour.ways[planes[i]].target, light.back());
        turn_sums.cross += sums.cross;
        turn_sums.square += sums.square;
      }
      // Of all planes, the sums need no others.
      colour.fit_scale(turn_sums, std::min(0.7, 1 - double(planes.size()) / double(colour.ways.size())));
      for (size_t i = 0; i < planes.size(); ++i)
        colour.lights[planes[i]].error = colour.add_gradient(colour.ways[planes[i]], group, std::move(light[i]),
                                                             samples[i], part(colour), levels, slopes);
    }
    convergence.push_back(loss());
    const double fall = (1 + std::cos(pi * iteration / iterations)) / 2, t = iteration + 1;
    const double correction = std::sqrt(1 - std::pow(beta2, t)) / (1 - std::pow(beta1, t));
    const AdamStep adam{float(beta1), float(beta2), float(step * fall * correction), 1e-20F};
    for (size_t m = 0; m < frames.size(); ++m)
      parallel_for(
          0, ny,
          [&](int64_t row) {
            const int j = int(row);
            Drive& drive = drives[m];
            adam_step(adam, slopes[m].row(j), drive.mean.row(j), drive.square.row(j), drive.level.row(j), size_t(nx));
            settle_drive(turn, float(frames[m].levels), drive.level.row(j), levels[m].row(j), size_t(nx));
          },
          {}, 16);
    observer.status(fmt::format("loss {:.1f} dB", 10 * std::log10(std::max(convergence.back(), 1e-30))));
    observer.progress((iteration + 1.0) / iterations);
  }
  for (const auto& colour : colours) colour->judge(levels);
  convergence.push_back(loss());
  for (size_t m = 0; m < frames.size(); ++m)
    std::copy(levels[m].values.begin(), levels[m].values.end(), frames[m].level.values.begin());
  observer.fact("iterations", iterations);
  observer.fact("loss_first", Fact(convergence.front()));
  observer.fact("loss_last", Fact(convergence.back()));
  observer.curve("convergence", convergence);
  tell_quality(colours, observer, frames);
}

}  // namespace holotrace
