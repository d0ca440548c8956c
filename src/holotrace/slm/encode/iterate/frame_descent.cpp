#include "holotrace/slm/encode/iterate/frame_descent.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "holotrace/base/error.h"
#include "holotrace/base/units.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/slm/encode/iterate/target_sums.h"

namespace holotrace {
namespace {

constexpr double not_known = -1;  // the error of a plane

// Where the last part of the schedule begins, and the whole one of a near start (DescentStart).
constexpr double late_from = 0.75;

}  // namespace

WavelengthDescent::WavelengthDescent(const Slm& slm, const Hologram& hologram, double wavelength,
                                     const EncodeParams& params, FrameArrays& frames)
    : wavelength_(wavelength),
      pixels_(slm.grid),
      panel_(slm, hologram, wavelength, params.subpixels),
      wavelength_light_(frames.light_of(panel_, wavelength)) {}

void WavelengthDescent::add(const TargetPlane& target) {
  wavelength_light_->add(target);
  targets_.push_back(&target);
  errors_.push_back(not_known);
  powers_.push_back(target_power(target));
  power_ += powers_.back();
  peak_ = std::max(peak_, target_peak(target));
  if (target.weight.size() == 0) weight_ += double(target.amplitude.size());
  for (const float w : target.weight.values) weight_ += double(w);
  are_smooth_ = are_smooth_ && is_smooth(target);
}

void WavelengthDescent::add(const ViewTargets& views) {
  views_.push_back(&views);
  errors_.push_back(not_known);
  powers_.push_back(target_power(views));
  power_ += powers_.back();
  for (const Array2D<float>& amplitude : views.amplitudes) {
    weight_ += double(amplitude.size());
    for (const float a : amplitude.values) peak_ = std::max(peak_, double(a));
  }
  are_smooth_ = false;
}

double WavelengthDescent::error() const {
  double error = 0, power = 0;
  for (size_t k = 0; k < errors_.size(); ++k)
    if (errors_[k] != not_known) {
      error += errors_[k];
      power += powers_[k];
    }
  return power > 0 ? error * power_ / power : power_;
}

void WavelengthDescent::judge() {
  leave();
  ModulusSums all;
  std::vector<ModulusSums> sums;
  light_ = 0;
  const auto add_sums = [&](const ModulusSums& one, double pixels_of_sample) {
    sums.push_back(one);
    all.cross += one.cross;
    all.square += one.square;
    light_ += one.square * pixels_of_sample / (double(turns()) * double(pixels_.pixels()));
  };
  for (size_t k = 0; k < targets_.size(); ++k) add_sums(wavelength_light_->plane_sums(k, SampleGroup::all, false), 1);
  for (const ViewTargets* views : views_)
    add_sums(wavelength_light_->view_sums(*views, false), std::pow(views->picture.pitch / pixels_.pitch, 2));
  fit_scale(all, 0);
  for (size_t k = 0; k < sums.size(); ++k)
    errors_[k] = powers_[k] - 2 * scale_ * sums[k].cross + scale_ * scale_ * sums[k].square;
}

void WavelengthDescent::add_views(const ViewTargets& views, double factor) {
  const double light = target_power(views);
  if (light == 0) return;
  constexpr double memory = 0.7;
  const ModulusSums sums = wavelength_light_->view_sums(views, true);
  if (targets_.empty()) fit_scale(sums, memory);
  const double error = wavelength_light_->add_gradient_of_views(views, scale_, factor / light);
  if (!targets_.empty()) return;
  for (size_t k = 0; k < views_.size(); ++k)
    if (views_[k]->z == views.z) errors_[k] = error / light * powers_[k];
}

// The scale that fits the planes of the latest turns: the sums of each earlier update count `memory` times those of
// the next one, because the light in the planes grows while the frames are found.
void WavelengthDescent::fit_scale(const ModulusSums& turn, double memory) {
  recent_.cross = memory * recent_.cross + turn.cross;
  recent_.square = memory * recent_.square + turn.square;
  scale_ = recent_.square > 0 && recent_.cross > 0 ? recent_.cross / recent_.square : 1;
}

void WavelengthDescent::add_planes(const std::vector<size_t>& planes, SampleGroup samples, double factor) {
  ModulusSums turn;
  for (const size_t plane : planes) {
    const ModulusSums sums = wavelength_light_->plane_sums(plane, samples, true);
    turn.cross += sums.cross;
    turn.square += sums.square;
  }
  // Of all planes, the sums need no others.
  fit_scale(turn, std::min(0.7, 1 - double(planes.size()) / double(targets_.size())));
  for (const size_t plane : planes) errors_[plane] = wavelength_light_->add_gradient(plane, samples, scale_, factor);
}

namespace {

// Weight of the error of an update's views, relative to their light, against that of its planes. Views gain nothing from
// 2, and planes lose 6 dB (docs/explanation/encoders.md).
constexpr double view_weight = 0.5;

}  // namespace

WavelengthDescents wavelength_descents(const TargetSet& targets, const DescentSetup& setup, const Hologram& hologram,
                                       FrameArrays& frames) {
  WavelengthDescents colours;
  for (const double wavelength : wavelengths_of(targets)) {
    colours.push_back(std::make_unique<WavelengthDescent>(setup.slm, hologram, wavelength, setup.params, frames));
    for (const TargetPlane& plane : targets.planes)
      if (plane.wavelength == wavelength) colours.back()->add(plane);
    for (const ViewTargets& views : targets.views)
      if (views.wavelength == wavelength) colours.back()->add(views);
  }
  return colours;
}

FrameDescent::FrameDescent(const TargetSet& targets, const DescentSetup& setup, const std::vector<Hologram>& frames,
                           std::unique_ptr<FrameArrays> arrays)
    : targets_(targets),
      params_(setup.params),
      grid_(setup.slm.grid),
      iterations_(setup.start.is_near ? next_iterations_of(setup.params) : iterations_of(setup.params)),
      levels_(frames.front().levels),
      first_progress_(setup.start.is_near ? late_from : 0),
      arrays_of_state_(arrays_of_state(frames)),
      arrays_(std::move(arrays)),
      wavelengths_(wavelength_descents(targets, setup, frames.front(), *arrays_)),
      last_update_(iterations_) {
  for (const auto& colour : wavelengths_) {
    lit_wavelengths_ += colour->power() > 0;
    plane_schedules_.emplace_back(colour->turns(), params_.planes_per_update, uint64_t(params_.seed));
  }
  // The error in a single plane falls so low that the one sample which stands for a pixel would limit it.
  const bool is_one_enough = std::all_of(wavelengths_.begin(), wavelengths_.end(), [](const auto& colour) {
    return colour->has_smooth_targets() && colour->targets().size() != 1;
  });
  has_single_samples_ = samples_of(samples_of_update(params_.subpixels, 0, is_one_enough), 4).size() == 1;
  const DrivenPanel& panel = wavelengths_.front()->panel();
  levels_per_cycle_ = wavelengths_.size() == 1 ? float(panel.levels_per_cycle()) : 0;
  set_step(params_.step > 0 ? params_.step : sgd_step);
}

void FrameDescent::set_step(double radians) {
  level_step_ = radians * wavelengths_.front()->panel().levels_per_radian();
  modulus_step_ = radians * (levels_ - 1);
}

// The schedule from a near start: levels whose error is larger must move farther. Measured in docs/explanation/encoders.md.
void FrameDescent::fit_to_first_loss() {
  const double loss = losses_.front();
  if (params_.step == 0) set_step(std::min(sgd_step, sgd_next_step * std::sqrt(loss)));
  const int most = iterations_of(params_), least = std::min(next_iterations_of(params_), most);
  if (params_.next_iterations > 0) return;
  const double wanted = most * loss / sgd_far_loss;  // beyond all bounds for frames that show quite another picture
  iterations_ = wanted < most ? std::max(int(std::lround(wanted)), least) : most;
}

// Updates until each plane of each colour has had its turn.
int FrameDescent::updates_per_round() const {
  size_t most = 1;
  for (const PlaneSchedule& planes : plane_schedules_) most = std::max(most, planes.updates_per_round());
  return int(most);
}

void FrameDescent::judge() {
  arrays_->end_steps();
  for (const auto& colour : wavelengths_) colour->judge();
}

// Each colour is weighted by its own light, so that dim colours count as much as bright ones; dark ones do not count.
double FrameDescent::loss_weight(const WavelengthDescent& colour) const {
  return colour.power() > 0 ? 1 / (colour.power() * lit_wavelengths_) : 0;
}

double FrameDescent::loss() const {
  double sum = 0;
  for (const auto& colour : wavelengths_) sum += colour->error() * loss_weight(*colour);
  return sum;
}

void FrameDescent::update() {
  arrays_->clear_slopes();
  for (size_t c = 0; c < wavelengths_.size(); ++c) {
    WavelengthDescent& colour = *wavelengths_[c];
    if (colour.power() == 0) continue;
    colour.leave(detail(updates()));
    const std::vector<size_t> planes = plane_schedules_[c].take();
    double weight = 1;
    if (!colour.targets().empty()) {
      const bool takes_one = has_single_samples_ && !is_late(updates());
      colour.add_planes(planes, samples_of_update(params_.subpixels, plane_schedules_[c].round(), takes_one),
                        loss_weight(colour));
      weight = view_weight * double(planes.size()) / double(colour.targets().size());  // of the planes' light
    }
    if (targets_.draw_views)
      colour.add_views(targets_.draw_views(updates(), colour.wavelength()), weight / lit_wavelengths_);
  }
  losses_.push_back(loss());
  if (first_progress_ > 0 && updates() == 1) {
    fit_to_first_loss();
    last_update_ = iterations_;
  }
  step();
  end_if_little_is_gained();
}

// How far the schedule is after some updates, from 0 to 1.
double FrameDescent::progress(int updates) const {
  const auto planned = [&](int done) { return first_progress_ + (1 - first_progress_) * done / iterations_; };
  if (ending_from_ < 0) return planned(updates);
  const double from = planned(ending_from_);
  return from + (1 - from) * (updates - ending_from_) / (last_update_ - ending_from_);
}

// How hard levels are after some updates. Up to 16 levels, the first part of the schedule leads from soft levels to whole
// ones: a shorter part for two levels, which are far apart. For more levels it makes no difference.
float FrameDescent::hardness(int updates) const {
  if (levels_ > 16) return 1;
  const double hard_from = levels_ == 2 ? 0.15 : 0.7;
  return float(std::min(1.0, progress(updates) / hard_from));
}

// Most of the schedule need neither know crosstalk exactly nor take more than one sample of each pixel of smooth targets: its
// last part corrects what that spoils.
bool FrameDescent::is_late(int updates) const { return progress(updates) >= late_from; }

// Whether losses from `first` to `last` cannot be compared.
bool FrameDescent::has_change(int first, int last) const {
  const bool differs_late = has_single_samples_ || wavelengths_.front()->panel().has_crosstalk();
  return differs_late && is_late(first) != is_late(last);
}

// How an update takes the panel. The start has whole levels. Slopes of the mean light over each pixel are cheaper than
// exact ones, and cost at most 0.2 dB (docs/explanation/encoders.md).
PanelDetail FrameDescent::detail(int updates) const {
  return {.is_hard = updates == 0 || hardness(updates) == 1,
          .light = is_late(updates) ? PixelDetail::as_shown : PixelDetail::coarse,
          .slopes = PixelDetail::mean};
}

// Compares the mean losses of two windows of updates. Each has all planes and samples in equal parts: two rounds of all
// planes or more, four if each takes a single sample. If the second one is not lower by params.least_gain, the rest of the
// schedule passes within one more window.
void FrameDescent::end_if_little_is_gained() {
  const int rounds = has_single_samples_ ? 4 : 2, whole = rounds * updates_per_round(), now = updates();
  const int window = (9 + whole) / whole * whole;  // 10 updates or more
  if (!(params_.least_gain > 0) || ending_from_ >= 0 || now < 2 * window || now + window >= iterations_) return;
  if (hardness(now - 2 * window) < 1 || has_change(now - 2 * window, now - 1)) return;
  const auto mean = [&](int end) {
    return std::accumulate(losses_.begin() + (end - window), losses_.begin() + end, 0.0) / window;
  };
  if (10 * std::log10(mean(now - window) / mean(now)) >= params_.least_gain) return;
  ending_from_ = now;
  last_update_ = now + window;
}

// A step of Adam (Kingma and Ba, 2015), which falls from its first size to 0 over the schedule as a half cosine.
void FrameDescent::step() {
  constexpr double beta1 = 0.5, beta2 = 0.99;     // the usual β₁ of 0.9 needs more iterations (encoders.md, "Steps")
  const int done = updates() - 1, t = updates();  // the update of now has its loss
  const double fall = (1 + std::cos(pi * progress(done))) / (1 + std::cos(pi * first_progress_));
  const double correction = std::sqrt(1 - std::pow(beta2, t)) / (1 - std::pow(beta1, t));
  const auto adam = [&](double whole_step) {
    return AdamStep{float(beta1), float(beta2), float(whole_step * fall * correction), 1e-20F};
  };
  arrays_->step({adam(level_step_), adam(modulus_step_), levels_per_cycle_, float(levels_), hardness(t)});
}

template <class Work>
void FrameDescent::each_number(const Work& work) {
  for (double& loss : losses_) work(loss);
  work(last_update_);
  work(ending_from_);
  for (const auto& colour : wavelengths_) colour->each_number(work);
  for (PlaneSchedule& planes : plane_schedules_) planes.each_number(work);
}

IterationState FrameDescent::state() {
  IterationState state{.updates = updates()};
  each_number([&](auto& number) { state.numbers.push_back(double(number)); });
  state.arrays = arrays_->state();
  return state;
}

void FrameDescent::restore(const IterationState& state) {
  const auto is_finite = [](double number) { return std::isfinite(number); };
  const bool is_sound = state.updates >= 0 && state.updates <= std::max(iterations_of(params_), iterations_) &&
                        std::all_of(state.numbers.begin(), state.numbers.end(), is_finite) &&
                        std::all_of(state.arrays.begin(), state.arrays.end(), [&](const Array2D<float>& array) {
                          return std::all_of(array.values.begin(), array.values.end(), is_finite);
                        });
  require(is_sound, "expected a state of gradient descent, but it is damaged; remove the checkpoint");
  losses_.resize(size_t(state.updates));
  size_t numbers = 0;
  each_number([&](auto&) { ++numbers; });
  require(numbers == state.numbers.size() && arrays_of_state_ == state.arrays.size(),
          "expected {} numbers and {} arrays in a state of gradient descent, got {} and {}; remove the checkpoint",
          numbers, arrays_of_state_, state.numbers.size(), state.arrays.size());
  for (const Array2D<float>& kept : state.arrays)
    require(kept.nx == grid_.nx && kept.ny == grid_.ny, "expected {} × {} pixels in a state, got {} × {}", grid_.nx,
            grid_.ny, kept.nx, kept.ny);
  size_t next = 0;
  each_number([&](auto& number) { number = std::decay_t<decltype(number)>(state.numbers[next++]); });
  if (first_progress_ > 0 && updates() > 0) fit_to_first_loss();
  arrays_->restore(state.arrays);
  for (const PlaneSchedule& planes : plane_schedules_)
    require(planes.are_sound(),
            "expected a state of gradient descent, but the order of its planes is damaged; remove the checkpoint");
}

}  // namespace holotrace
