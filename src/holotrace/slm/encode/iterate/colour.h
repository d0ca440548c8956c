#pragma once

#include <optional>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/driven_panel.h"
#include "holotrace/slm/encode/iterate/iteration_kernels.h"
#include "holotrace/slm/encode/iterate/pupil_propagation.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"

namespace holotrace {

/// A target and the way to it.
struct TargetWay {
  const TargetPlane* target;
  TargetPropagation propagation;
};

/// One wavelength of a gradient descent: the panel in its light, the propagations to its target planes, and what is
/// known of the light there. `levels` are the rounded levels of all frames.
class Colour {
 public:
  Colour(const Slm& slm, const Hologram& hologram, double wavelength, const EncodeParams& params);

  /// Adds a target plane, which must outlive this object.
  void add(const TargetPlane& target);

  double wavelength() const { return wavelength_; }
  const DrivenPanel& panel() const { return panel_; }
  const std::vector<TargetWay>& ways() const { return ways_; }
  double power() const { return power_; }  ///< light of the targets
  double scale() const { return scale_; }  ///< the scale s of the light that fits the targets
  double error() const;                    ///< sum of the errors of all planes, each from its last turn
  double light() const { return light_; }  ///< sum of the light in all planes when they were last judged

  /// Light of all frames on the panel.
  void leave(const std::vector<Drive>& levels, const PanelDetail& detail = {});

  /// Error and sums of all planes for some levels.
  void judge(const std::vector<Drive>& levels);

  /// Adds the gradient of the errors of some planes by the levels of each frame, times factor, for the light that left
  /// last. The scale follows the planes of the latest turns.
  /// @param round  rounds of all planes that have begun: which samples of the pixels count
  void add_planes(const std::vector<size_t>& planes, uint64_t round, double factor, const std::vector<Drive>& levels,
                  std::vector<Drive>& slopes);

  /// Adds the gradient of the error of some views, at the scale of the planes, as a fraction of their light.
  void add_views(const ViewTargets& views, double factor, const std::vector<Drive>& levels, std::vector<Drive>& slopes);

  /// Calls work(number) for each number that outlasts an update; it may change them.
  template <class Work>
  void each_number(const Work& work) {
    work(recent_.cross);
    work(recent_.square);
    work(scale_);
    for (double& error : errors_) work(error);
  }

 private:
  using Samples = std::vector<std::vector<Field>>;  // of each frame

  // The mean irradiance of the frames in a target plane, and the samples that it is the mean of.
  struct PlaneLight {
    Array2D<float> mean;
    Samples samples;
  };

  SampleGroup group_of(uint64_t round) const;
  Array2D<float> mean_light(const TargetWay& way, SampleGroup group, Samples* samples) const;
  bool has_pixel_means(SampleGroup group) const;
  void fit_scale(const ModulusSums& turn, double memory);
  double add_gradient(const TargetWay& way, SampleGroup group, PlaneLight&& light, double factor,
                      const std::vector<Drive>& levels, std::vector<Drive>& slopes) const;

  const Slm& slm_;
  const EncodeParams& params_;
  double wavelength_;
  DrivenPanel panel_;
  std::vector<TargetWay> ways_;
  std::vector<double> errors_;              // of each plane, from its last turn
  std::vector<Field> u_;                    // light that leaves the panel, of each frame
  std::optional<PupilPropagation> pupils_;  // made for the first views
  ModulusSums recent_;
  double scale_ = 1, power_ = 0, light_ = 0;
  PanelDetail detail_;  // of the light that left last
};

}  // namespace holotrace
