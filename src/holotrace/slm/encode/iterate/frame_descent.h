#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "holotrace/base/random.h"
#include "holotrace/data/checkpoint.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"

namespace holotrace {

/// One wavelength of a gradient descent: the panel in its light, its targets, and what is known of the light there. The
/// targets are planes or, without planes, views.
class WavelengthDescent {
 public:
  /// @param hologram  its levels and modulation are used
  /// @param frames    the frames whose light it is; must outlive this object
  WavelengthDescent(const Slm& slm, const Hologram& hologram, double wavelength, const EncodeParams& params,
                    FrameArrays& frames);

  /// Adds a target plane, or views that are judged, which must outlive this object.
  void add(const TargetPlane& target);
  void add(const ViewTargets& views);

  double wavelength() const { return wavelength_; }
  const DrivenPanel& panel() const { return panel_; }
  const std::vector<const TargetPlane*>& targets() const { return targets_; }
  size_t turns() const { return errors_.size(); }  ///< number of planes, or without planes of views
  double power() const { return power_; }          ///< light of the targets
  double peak() const { return peak_; }            ///< largest amplitude that is wanted
  double weight() const { return weight_; }        ///< sum of the weights of all samples
  double scale() const { return scale_; }          ///< the scale s of the light that fits the targets

  /// Sum of the errors of all planes, each from its last turn. Those that had none yet count as much, relative to their light,
  /// as those that had one; before the first turn, it is their light.
  double error() const;
  bool has_smooth_targets() const { return are_smooth_; }  ///< one sample of each pixel can stand for its mean
  double light() const { return light_; }  ///< part of the panel's light in the targets when they were last judged

  /// Light of all frames on the panel.
  void leave(const PanelDetail& detail = {}) { wavelength_light_->leave(detail); }

  /// Error and sums of all planes for the levels of now.
  void judge();

  /// Adds the gradient of the errors of some planes to the slopes of the frames, times factor, for the light that left
  /// last. The scale follows the planes of the latest turns.
  void add_planes(const std::vector<size_t>& planes, SampleGroup samples, double factor);

  /// Adds the gradient of the error of some views, as a fraction of their light. They take the scale of the planes; without
  /// planes the scale follows them, and their error is that of the judged views in their plane.
  void add_views(const ViewTargets& views, double factor);

  /// Calls work(number) for each number that outlasts an update; it may change them.
  template <class Work>
  void each_number(const Work& work) {
    work(recent_.cross);
    work(recent_.square);
    work(scale_);
    for (double& error : errors_) work(error);
  }

 private:
  void fit_scale(const ModulusSums& turn, double memory);

  double wavelength_;
  Grid pixels_;
  DrivenPanel panel_;
  std::unique_ptr<WavelengthLight> wavelength_light_;
  std::vector<const TargetPlane*> targets_;
  std::vector<const ViewTargets*> views_;
  std::vector<double> errors_, powers_;  // of each plane or view: error from its last turn, and light of the target
  ModulusSums recent_;
  double scale_ = 1, power_ = 0, peak_ = 0, weight_ = 0, light_ = 0;
  bool are_smooth_ = true;
};

/// The planes of each update: all of them have their turn, in an order that is random for each round.
class PlaneSchedule {
 public:
  PlaneSchedule(size_t planes, int per_update, uint64_t seed)
      : order_(planes),
        per_update_(per_update == 0 ? planes : std::min(planes, size_t(per_update))),
        next_(planes),
        seed_(seed) {
    std::iota(order_.begin(), order_.end(), size_t(0));
  }

  /// Number of rounds that have begun.
  uint64_t round() const { return round_; }

  /// Updates until all planes have had their turn.
  size_t updates_per_round() const { return (order_.size() + per_update_ - 1) / per_update_; }

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

  /// Whether each plane has one place in the order, as after a change by each_number.
  bool are_sound() const {
    std::vector<size_t> sorted = order_;
    std::sort(sorted.begin(), sorted.end());
    for (size_t k = 0; k < sorted.size(); ++k)
      if (sorted[k] != k) return false;
    return next_ <= order_.size();
  }

  /// Calls work(number) for each number that the next turns depend on; it may change them.
  template <class Work>
  void each_number(const Work& work) {
    work(next_);
    work(round_);
    for (size_t& plane : order_) work(plane);
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

using WavelengthDescents = std::vector<std::unique_ptr<WavelengthDescent>>;

/// How the frames of a descent begin.
struct DescentStart {
  /// Whether the levels are near their goal, as those of a film's last picture are. The schedule then is the last part of the one
  /// from other starts: levels are whole from the first update on. Its length and its first step follow from the loss of these
  /// levels, unless params.next_iterations and params.step give them.
  bool is_near = false;
  size_t fixed =
      0;  ///< number of frames, the first ones, that stay as they are: the others are found for the mean light of all
};

/// A panel and what is asked of its levels.
struct DescentSetup {
  const Slm& slm;
  const EncodeParams& params;
  DescentStart start{};
};

/// The wavelengths of some targets, in their order, for a panel with the hologram's levels and modulation.
WavelengthDescents wavelength_descents(const TargetSet& targets, const DescentSetup& setup, const Hologram& hologram,
                                       FrameArrays& frames);

/// Frames that are found together by the updates of gradient_descent.h, one after the other. All that one update leaves
/// to the next is in state(): restored in another object of the same job, the updates that follow are the same.
class FrameDescent {
 public:
  /// @param targets, setup  must outlive this object
  /// @param frames  their number, levels and modulation are used
  /// @param arrays  holds their levels, the start
  FrameDescent(const TargetSet& targets, const DescentSetup& setup, const std::vector<Hologram>& frames,
               std::unique_ptr<FrameArrays> arrays);

  /// Loss before each update that is done.
  const std::vector<double>& losses() const { return losses_; }

  int updates() const { return int(losses_.size()); }

  /// Number of updates after which it is finished: as many as asked for, or fewer if they gain too little.
  int last_update() const { return last_update_; }

  /// Ends the updates, and evaluates all planes for the levels of now.
  void judge();

  void update();

  /// The loss of the levels of now.
  double loss() const;

  const WavelengthDescents& wavelengths() const { return wavelengths_; }

  /// Writes the rounded levels.
  void write(std::vector<Hologram>& frames) const { arrays_->write(frames); }

  IterationState state();
  void restore(const IterationState& state);

 private:
  int updates_per_round() const;
  /// Weight of a wavelength in the loss.
  double loss_weight(const WavelengthDescent& colour) const;
  /// Progress of the schedule after some updates, from 0 to 1.
  double progress(int updates) const;
  float hardness(int updates) const;
  bool is_late(int updates) const;
  bool has_change(int first, int last) const;
  PanelDetail detail(int updates) const;
  void set_step(double radians);
  void fit_to_first_loss();
  void step();
  void end_if_little_is_gained();
  template <class Work>
  void each_number(const Work& work);

  const TargetSet& targets_;
  const EncodeParams& params_;
  const Grid grid_;
  int iterations_;
  const int levels_;
  const double first_progress_;
  const size_t arrays_of_state_;
  std::unique_ptr<FrameArrays> arrays_;
  WavelengthDescents wavelengths_;
  std::vector<PlaneSchedule> plane_schedules_;  // of each colour
  double lit_wavelengths_ = 0;                  // number of them that have light
  float levels_per_cycle_ = 0;                  // levels of 2π of phase; 0: drives do not wrap
  double level_step_, modulus_step_;
  std::vector<double> losses_;
  bool has_single_samples_ = false;  // until the last part
  int last_update_;
  int ending_from_ = -1;  // number of updates after which it began to end early; −1: it did not
};

}  // namespace holotrace
