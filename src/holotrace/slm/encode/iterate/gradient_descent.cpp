#include "holotrace/slm/encode/iterate/gradient_descent.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/random.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/iterate/colour.h"
#include "holotrace/slm/encode/iterate/iteration_kernels.h"
#include "holotrace/slm/encode/iterate/iterations.h"
#include "holotrace/slm/encode/iterate/target_sums.h"

namespace holotrace {
namespace {

Array2D<float> levels_of(const Hologram& hologram) {
  Array2D<float> levels(hologram.level.ny, hologram.level.nx);
  std::copy(hologram.level.values.begin(), hologram.level.values.end(), levels.values.begin());
  return levels;
}

using Colours = std::vector<std::unique_ptr<Colour>>;

Colours colours_of(const std::vector<TargetPlane>& targets, const Slm& slm, const EncodeParams& params,
                   const Hologram& hologram) {
  Colours colours;
  for (const TargetPlane& target : targets) {
    auto found = std::find_if(colours.begin(), colours.end(),
                              [&](const auto& colour) { return colour->wavelength() == target.wavelength; });
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
    for (const TargetWay& way : colour->ways()) peak = std::max(peak, target_peak(*way.target));
    if (peak == 0) continue;
    error += colour->error() / (peak * peak);
    for (const TargetWay& way : colour->ways()) {
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
      if (colour->wavelength() == frame.wavelength) frame.illumination = colour->scale() * colour->scale();
    light += colour->light() / (double(colour->ways().size()) * double(frames.front().grid.pixels()));
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
  for (const auto& colour : colours) lit += colour->power() > 0;
  const auto part = [&](const Colour& colour) { return colour.power() > 0 ? 1 / (colour.power() * lit) : 0; };
  const auto loss = [&] {
    double sum = 0;
    for (const auto& colour : colours) sum += colour->error() * part(*colour);
    return sum;
  };

  const DrivenPanel& first = colours.front()->panel();
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
    turns.emplace_back(colour->ways().size(), params.planes_per_update, uint64_t(params.seed));
  if (iterations > 0)
    for (const auto& colour : colours) colour->judge(levels);  // planes count from the start, before their first turn
  std::vector<double> convergence;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    for (Array2D<float>& slope : slopes) std::fill(slope.values.begin(), slope.values.end(), 0.0F);
    const bool is_view = targets.draw_views && iteration % 2 == 1;
    for (size_t c = 0; c < colours.size(); ++c) {
      Colour& colour = *colours[c];
      if (colour.power() == 0) continue;
      colour.leave(levels);
      if (is_view) {
        colour.add_views(targets.draw_views(iteration, colour.wavelength()), 1 / lit, levels, slopes);
        continue;
      }
      const std::vector<size_t> planes = turns[c].take();
      colour.add_planes(planes, turns[c].round(), part(colour), levels, slopes);
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
