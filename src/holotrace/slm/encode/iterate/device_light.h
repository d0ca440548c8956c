#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "holotrace/slm/encode/iterate/device_arrays.h"
#include "holotrace/slm/encode/iterate/processor_light.h"
#include "holotrace/slm/encode/iterate/share_light.h"

namespace holotrace {

/// The light of all frames on OpenCL devices, each of which computes that of its share. Of one device, only the row sums of
/// the planes leave it.
///
/// **Of several devices**, each computes its frames' part of the mean irradiance of a plane. The parts of the others go to the
/// first one, by way of the processor, which adds them in the order of the shares. The first one has the target; what the
/// residual's factor is there goes back to the others. So for each plane of an update 4 bytes per pixel leave each device but the
/// first and 4 arrive there; 4 arrive at the first one and 4 leave it. Views are the same, with the pixels of their pictures.
///
/// **With frames of other processes** (OtherFrames), the first device's sum goes on to them in the same way.
class DeviceLight : public ColourLight {
 public:
  /// @param shares  must outlive this object
  DeviceLight(const std::vector<std::unique_ptr<FrameShare>>& shares, const PanelInLight& panel,
              const OtherFrames& others = {});

  void add(const TargetPlane& target) override;
  void leave(const PanelDetail& detail) override;
  ModulusSums plane_sums(size_t plane, SampleGroup group, bool is_kept) override;
  double add_gradient(size_t plane, SampleGroup group, double scale, double factor) override;
  ModulusSums view_sums(const ViewTargets& views, bool is_kept) override;
  double add_gradient_of_views(const ViewTargets& views, double scale, double factor) override;

 private:
  using Part = std::function<const DeviceBuffer&(const ShareLight& share)>;
  void on_all(const std::function<void(ShareLight& share)>& work);
  void add_parts(const Part& part);
  void add_other_processes(const Part& part);
  void send_to_others(const Part& part);

  const std::vector<std::unique_ptr<FrameShare>>& shares_;
  PanelInLight lit_;
  OtherFrames others_;
  size_t frames_ = 0;                                // of all processes
  std::vector<std::unique_ptr<ShareLight>> lights_;  // of each share
  std::vector<std::vector<float>> parts_{};          // of all but the first, on the processor
  PupilPropagations pupils_;
};

}  // namespace holotrace
