#pragma once

#include <complex>
#include <map>
#include <memory>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"

namespace holotrace {

/// A panel that drives light of one wavelength. All of it must outlive what uses it.
struct PanelInLight {
  const Slm& slm;
  const EncodeParams& params;
  const DrivenPanel& panel;
  double wavelength;
};

/// The light of frames on the processor.
class ProcessorLight : public WavelengthLight {
 public:
  /// @param levels  rounded drives of the frames
  /// @param slopes  gradients are added here
  /// @param others  frames of other processes: planes show the mean light of all
  /// @param fixed   number of frames, the first ones, that get no gradients
  ProcessorLight(const PanelInLight& panel, const std::vector<Drive>& levels, std::vector<Drive>& slopes,
                 const OtherFrames& others = {}, size_t fixed = 0)
      : lit_(panel), levels_(levels), slopes_(slopes), others_(others), fixed_(fixed) {}

  void add(const TargetPlane& target) override;
  void leave(const PanelDetail& detail) override;
  ModulusSums plane_sums(size_t plane, SampleGroup group, bool is_kept) override;
  double add_gradient(size_t plane, SampleGroup group, double scale, double factor) override;
  ModulusSums view_sums(const ViewTargets& views, bool is_kept) override;
  double add_gradient_of_views(const ViewTargets& views, double scale, double factor) override;

 private:
  // A target and the way to it.
  struct TargetWay {
    const TargetPlane* target;
    TargetPropagation propagation;
  };
  using Samples = std::vector<std::vector<Field>>;  // of each frame that is not fixed

  // The mean irradiance of the frames in a target plane, and the samples that it is the mean of.
  struct PlaneLight {
    Array2D<float> mean;
    Samples samples;
  };

  // The mean irradiance in the pictures of some views, and the pictures of each frame that is not fixed.
  struct ViewLight {
    std::vector<Array2D<float>> mean;
    std::vector<std::vector<Array2D<std::complex<float>>>> pictures;
  };

  bool has_means(SampleGroup group) const { return has_pixel_means(group, lit_.params.subpixels); }
  double frames() const { return double(levels_.size() + others_.count); }
  Array2D<float> mean_light(const TargetWay& way, SampleGroup group, Samples* samples) const;

  PanelInLight lit_;
  const std::vector<Drive>& levels_;
  std::vector<Drive>& slopes_;
  OtherFrames others_;
  size_t fixed_;
  std::vector<TargetWay> ways_;
  std::vector<Field> u_;               // light that leaves the panel, of each frame
  PanelDetail detail_;                 // of that light
  std::map<size_t, PlaneLight> kept_;  // of planes whose gradient is not added yet
  ViewLight kept_views_;
  PupilPropagations pupils_;
};

/// The levels of a hologram, as a drive.
Drive drive_of(const Hologram& hologram);

/// The frames of a gradient descent in the processor's memory.
class ProcessorFrames : public FrameArrays {
 public:
  /// @param slm, params  must outlive this object
  /// @param frames       their levels are the start
  /// @param others       frames of other processes
  /// @param fixed        number of frames, the first ones, that stay as they are
  ProcessorFrames(const Slm& slm, const EncodeParams& params, const std::vector<Hologram>& frames,
                  const OtherFrames& others = {}, size_t fixed = 0);

  std::unique_ptr<WavelengthLight> light_of(const DrivenPanel& panel, double wavelength) override;
  void clear_slopes() override;
  void step(const DriveStep& step) override;
  void end_steps() override;
  void write(std::vector<Hologram>& frames) const override;
  std::vector<Array2D<float>> state() override;
  void restore(const std::vector<Array2D<float>>& state) override;

 private:
  struct Frame {
    Drive drive, mean, square;
  };
  void prepare_steps();
  template <class Work>
  void each_array_of_state(const Work& work);

  const Slm& slm_;
  const EncodeParams& params_;
  OtherFrames others_;
  size_t fixed_;
  std::vector<Drive> rounded_, slopes_;  // of each frame
  std::vector<Frame> frames_;            // empty until the first step: frames that are only judged need none
  bool have_steps_ended_ = false;
};

/// @param processes  of this machine that each have so many frames
/// @throws Error     if the memory does not suffice for a descent on the processor
void require_memory_for_descent(size_t planes, const Slm& slm, const EncodeParams& params,
                                const std::vector<Hologram>& frames, int processes = 1);

}  // namespace holotrace
