#include "holotrace/slm/encode/iterate/frame_descent.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "holotrace/base/error.h"
#include "holotrace/base/memory.h"
#include "holotrace/base/threads.h"
#include "holotrace/base/units.h"
#include "holotrace/slm/encode/iterate/iteration_kernels.h"
#include "holotrace/slm/encode/iterate/iterations.h"

namespace holotrace {
namespace {

// Weight of the error of an update's views, relative to their light, against that of its planes. Views gain nothing from
// 2, and planes lose 6 dB (docs/explanation/encoders.md).
constexpr double view_weight = 0.5;

// Transfer functions and targets of the planes; drive, moments, slope, light and samples of the frames.
void require_memory_for(size_t planes, size_t frames, const Grid& grid, const EncodeParams& params, size_t arrays) {
  const double fine = double(params.subpixels) * params.subpixels, samples = params.subpixels > 1 ? fine : 4;
  const size_t at_once = params.planes_per_update == 0 ? planes : std::min(planes, size_t(params.planes_per_update));
  const double of_plane = 4 + 16 * fine, of_frame = 20 * double(arrays) + 8 * fine + 8 * samples * double(at_once);
  require_memory(double(grid.pixels()) * (of_plane * double(planes) + of_frame * double(frames)),
                 fmt::format("gradient descent for {} frame(s) of {} × {} pixels and {} target plane(s)", frames,
                             grid.nx, grid.ny, planes));
}

template <class From, class To>
void copy_values(const Array2D<From>& from, Array2D<To>& to) {
  std::copy(from.values.begin(), from.values.end(), to.values.begin());
}

}  // namespace

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

Drive drive_of(const Hologram& hologram) {
  Drive drive{Array2D<float>(hologram.level.ny, hologram.level.nx),
              Array2D<float>(hologram.modulus_level.ny, hologram.modulus_level.nx)};
  copy_values(hologram.level, drive.level);
  copy_values(hologram.modulus_level, drive.modulus);
  return drive;
}

FrameDescent::FrameDescent(const TargetSet& targets, const Slm& slm, const EncodeParams& params,
                           const std::vector<Hologram>& frames)
    : targets_(targets),
      params_(params),
      iterations_(iterations_of(params)),
      levels_(frames.front().levels),
      last_update_(iterations_) {
  require_memory_for(targets.planes.size(), frames.size(), slm.grid, params,
                     frames.front().modulation == Modulation::complex ? 2 : 1);
  colours_ = colours_of(targets.planes, slm, params, frames.front());
  for (const auto& colour : colours_) {
    lit_ += colour->power() > 0;
    turns_.emplace_back(colour->ways().size(), params.planes_per_update, uint64_t(params.seed));
  }
  const DrivenPanel& panel = colours_.front()->panel();
  turn_ = colours_.size() == 1 ? float(panel.turn()) : 0;
  const double step = params.step > 0 ? params.step : sgd_step;
  level_step_ = step * panel.levels_per_radian();
  modulus_step_ = step * (levels_ - 1);
  for (const Hologram& frame : frames) {
    rounded_.push_back(drive_of(frame));
    frames_.push_back({rounded_.back(), Drive::like(rounded_.back()), Drive::like(rounded_.back())});
    slopes_.push_back(Drive::like(rounded_.back()));
  }
}

// Updates until each plane of each colour has had its turn.
int FrameDescent::updates_per_round() const {
  size_t most = 1;
  for (const Turns& turns : turns_) most = std::max(most, turns.updates_per_round());
  return int(most);
}

void FrameDescent::judge() {
  for (const auto& colour : colours_) colour->judge(rounded_);
}

// Each colour is weighted by its own light, so that dim colours count as much as bright ones; dark ones do not count.
double FrameDescent::part(const Colour& colour) const { return colour.power() > 0 ? 1 / (colour.power() * lit_) : 0; }

double FrameDescent::loss() const {
  double sum = 0;
  for (const auto& colour : colours_) sum += colour->error() * part(*colour);
  return sum;
}

void FrameDescent::update() {
  for (Drive& slope : slopes_)
    each_array(slope, [](Array2D<float>& values) { std::fill(values.values.begin(), values.values.end(), 0.0F); });
  for (size_t c = 0; c < colours_.size(); ++c) {
    Colour& colour = *colours_[c];
    if (colour.power() == 0) continue;
    colour.leave(rounded_, detail(updates()));
    const std::vector<size_t> planes = turns_[c].take();
    colour.add_planes(planes, turns_[c].round(), part(colour), rounded_, slopes_);
    if (!targets_.draw_views) continue;
    const double share = double(planes.size()) / double(colour.ways().size());  // of the planes' light
    colour.add_views(targets_.draw_views(updates(), colour.wavelength()), view_weight * share / lit_, rounded_,
                     slopes_);
  }
  step();
  losses_.push_back(loss());
  end_if_little_is_gained();
}

// How far the schedule is after some updates, from 0 to 1.
double FrameDescent::place(int updates) const {
  if (ending_from_ < 0) return double(updates) / iterations_;
  const double from = double(ending_from_) / iterations_;
  return from + (1 - from) * (updates - ending_from_) / (last_update_ - ending_from_);
}

// How hard levels are after some updates. Up to 16 levels, the first part of the schedule leads from soft levels to whole
// ones: a shorter part for two levels, which are far apart. For more levels it makes no difference.
float FrameDescent::hardness(int updates) const {
  if (levels_ > 16) return 1;
  const double hard_from = levels_ == 2 ? 0.15 : 0.7;
  return float(std::min(1.0, place(updates) / hard_from));
}

// How an update takes the panel. Most of the schedule need not know crosstalk exactly: its last part corrects what that
// spoils. The start has whole levels.
PanelDetail FrameDescent::detail(int updates) const {
  constexpr double fine_from = 0.75;
  const bool has_coarse = colours_.front()->panel().has_coarse();
  return {.is_hard = updates == 0 || hardness(updates) == 1, .is_fine = !has_coarse || place(updates) >= fine_from};
}

// Compares the mean losses of two windows of updates, each of two rounds of all planes or more. If the second one is not
// lower by params.least_gain, the rest of the schedule passes within one more window.
void FrameDescent::end_if_little_is_gained() {
  const int window = std::max(10, 2 * updates_per_round()), now = updates();
  if (!(params_.least_gain > 0) || ending_from_ >= 0 || now < 2 * window || now + window >= iterations_) return;
  if (hardness(now - 2 * window) < 1 || !detail(now - 2 * window).is_fine) return;  // these change the loss
  const auto mean = [&](int end) {
    return std::accumulate(losses_.begin() + (end - window), losses_.begin() + end, 0.0) / window;
  };
  if (10 * std::log10(mean(now - window) / mean(now)) >= params_.least_gain) return;
  ending_from_ = now;
  last_update_ = now + window;
}

// A step of Adam (Kingma and Ba, 2015), which falls to 0 over the schedule as a half cosine.
void FrameDescent::step() {
  constexpr double beta1 = 0.9, beta2 = 0.99;
  const double fall = (1 + std::cos(pi * place(updates()))) / 2, t = updates() + 1;
  const double correction = std::sqrt(1 - std::pow(beta2, t)) / (1 - std::pow(beta1, t));
  const auto move = [&](double whole_step, float turn, Array2D<float> Drive::*values, size_t m) {
    const AdamStep adam{float(beta1), float(beta2), float(whole_step * fall * correction), 1e-20F};
    Frame& frame = frames_[m];
    parallel_for(
        0, (frame.drive.*values).ny,
        [&](int64_t row) {
          const int j = int(row);
          float* drive = (frame.drive.*values).row(j);
          const size_t nx = size_t((frame.drive.*values).nx);
          adam_step(adam, (slopes_[m].*values).row(j), (frame.mean.*values).row(j), (frame.square.*values).row(j),
                    drive, nx);
          settle_drive(turn, float(levels_), hardness(updates() + 1), drive, (rounded_[m].*values).row(j), nx);
        },
        {}, 16);
  };
  for (size_t m = 0; m < frames_.size(); ++m) {
    move(level_step_, turn_, &Drive::level, m);
    if (rounded_[m].modulus.size() > 0) move(modulus_step_, 0, &Drive::modulus, m);
  }
}

void FrameDescent::write(std::vector<Hologram>& frames) const {
  for (size_t m = 0; m < frames.size(); ++m) {
    copy_values(rounded_[m].level, frames[m].level);
    copy_values(rounded_[m].modulus, frames[m].modulus_level);
  }
}

template <class Work>
void FrameDescent::each_number(const Work& work) {
  for (double& loss : losses_) work(loss);
  work(last_update_);
  work(ending_from_);
  for (const auto& colour : colours_) colour->each_number(work);
  for (Turns& turns : turns_) turns.each_number(work);
}

template <class Work>
void FrameDescent::each_array_of_state(const Work& work) {
  for (size_t m = 0; m < frames_.size(); ++m)
    for (Drive* drive : {&rounded_[m], &frames_[m].drive, &frames_[m].mean, &frames_[m].square})
      each_array(*drive, work);
}

IterationState FrameDescent::state() {
  IterationState state{.updates = updates()};
  each_number([&](auto& number) { state.numbers.push_back(double(number)); });
  each_array_of_state([&](Array2D<float>& values) { state.arrays.push_back(values); });
  return state;
}

void FrameDescent::restore(const IterationState& state) {
  const auto is_finite = [](double number) { return std::isfinite(number); };
  const bool is_sound = state.updates >= 0 && state.updates <= iterations_ &&
                        std::all_of(state.numbers.begin(), state.numbers.end(), is_finite) &&
                        std::all_of(state.arrays.begin(), state.arrays.end(), [&](const Array2D<float>& array) {
                          return std::all_of(array.values.begin(), array.values.end(), is_finite);
                        });
  require(is_sound, "expected a state of gradient descent, but it is damaged; remove the checkpoint");
  losses_.resize(size_t(state.updates));
  size_t numbers = 0, arrays = 0;
  each_number([&](auto&) { ++numbers; });
  each_array_of_state([&](Array2D<float>&) { ++arrays; });
  require(numbers == state.numbers.size() && arrays == state.arrays.size(),
          "expected {} numbers and {} arrays in a state of gradient descent, got {} and {}; remove the checkpoint",
          numbers, arrays, state.numbers.size(), state.arrays.size());
  size_t next = 0;
  each_number([&](auto& number) { number = std::decay_t<decltype(number)>(state.numbers[next++]); });
  next = 0;
  each_array_of_state([&](Array2D<float>& values) {
    const Array2D<float>& kept = state.arrays[next++];
    require(kept.nx == values.nx && kept.ny == values.ny, "expected {} × {} pixels in a state, got {} × {}", values.nx,
            values.ny, kept.nx, kept.ny);
    values = kept;
  });
  for (const Turns& turns : turns_)
    require(turns.are_sound(),
            "expected a state of gradient descent, but its turns are damaged; remove the checkpoint");
}

}  // namespace holotrace
