#pragma once

#include <memory>
#include <vector>

#include "holotrace/data/checkpoint.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/colour.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/encode/iterate/turns.h"

namespace holotrace {

using Colours = std::vector<std::unique_ptr<Colour>>;

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
  double part(const Colour& colour) const;
  double place(int updates) const;
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
  std::vector<Turns> turns_;  // of each colour
  double lit_ = 0;            // number of colours that have light
  float turn_ = 0;            // levels of a whole turn of phase; 0 for none
  double level_step_, modulus_step_;
  std::vector<double> losses_;
  bool has_single_samples_ = false;  // until the last part
  int last_update_;
  int ending_from_ = -1;  // number of updates after which it began to end early; −1: it did not
};

}  // namespace holotrace
