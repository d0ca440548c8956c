#pragma once

#include <complex>
#include <map>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/data/params/encode.h"
#include "holotrace/data/slm.h"
#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/frame_exchange.h"
#include "holotrace/slm/encode/iterate/pupil_propagation.h"
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
  ProcessorLight(const PanelInLight& panel, const std::vector<Drive>& levels, std::vector<Drive>& slopes,
                 const OtherFrames& others = {})
      : lit_(panel), levels_(levels), slopes_(slopes), others_(others) {}

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
  using Samples = std::vector<std::vector<Field>>;  // of each frame

  // The mean irradiance of the frames in a target plane, and the samples that it is the mean of.
  struct PlaneLight {
    Array2D<float> mean;
    Samples samples;
  };

  // The mean irradiance in the pictures of some views, and the pictures of each frame.
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
  std::vector<TargetWay> ways_;
  std::vector<Field> u_;               // light that leaves the panel, of each frame
  PanelDetail detail_;                 // of that light
  std::map<size_t, PlaneLight> kept_;  // of planes whose gradient is not added yet
  ViewLight kept_views_;
  PupilPropagations pupils_;
};

}  // namespace holotrace
