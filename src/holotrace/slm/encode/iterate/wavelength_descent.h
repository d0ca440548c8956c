#pragma once

#include <memory>
#include <vector>

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

}  // namespace holotrace
