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
#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/encode/iterate/wavelength_descent.h"

namespace holotrace {

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

using Colours = std::vector<std::unique_ptr<WavelengthDescent>>;

/// A panel and what is asked of its levels.
struct DescentSetup {
  const Slm& slm;
  const EncodeParams& params;
};

/// The wavelengths of some targets, in their order, for a panel with the hologram's levels and modulation.
Colours colours_of(const TargetSet& targets, const DescentSetup& setup, const Hologram& hologram, FrameArrays& frames);

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

  const Colours& colours() const { return colours_; }

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
  void step();
  void end_if_little_is_gained();
  template <class Work>
  void each_number(const Work& work);

  const TargetSet& targets_;
  const EncodeParams& params_;
  const Grid grid_;
  const int iterations_, levels_;
  const size_t arrays_of_state_;
  std::unique_ptr<FrameArrays> arrays_;
  Colours colours_;
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
