#pragma once

#include <array>
#include <complex>
#include <map>
#include <optional>
#include <vector>

#include "holotrace/slm/encode/iterate/descent_arrays.h"
#include "holotrace/slm/encode/iterate/descent_loops.h"
#include "holotrace/slm/encode/iterate/device_driven_panel.h"
#include "holotrace/slm/encode/iterate/device_views.h"
#include "holotrace/slm/encode/iterate/processor_light.h"
#include "holotrace/wave/propagate/device_convolution.h"

namespace holotrace {

/// The mean irradiance of the frames in a plane, and their samples there, on a device.
struct DevicePlaneLight {
  std::vector<DeviceBuffer> samples;
  DeviceBuffer mean;
};

/// Memory of the light of all wavelengths, which are done one after the other.
struct DeviceLightMemory {
  std::vector<DeviceBuffer> u;        ///< light that leaves the panel, of each frame
  DeviceBuffer back;                  ///< what comes back to it
  std::array<DeviceBuffer, 4> power;  ///< at the samples of the pixels, of all frames
  DeviceBuffer pupil;                 ///< light in the plane of a pupil, or of all
  DevicePanel::Memory panel;
  DeviceConvolution::Work work;
  std::vector<DevicePlaneLight> spare;  ///< light of planes whose gradient is added
};

/// The light of frames on an OpenCL device. Only the row sums of the planes leave it.
class DeviceLight : public ColourLight {
 public:
  DeviceLight(Device& device, const PanelInLight& panel, std::vector<DeviceFrame>& frames, DeviceLightMemory& memory)
      : device_(device), lit_(panel), panel_(device, panel.panel), frames_(frames), memory_(memory) {}

  void add(const TargetPlane& target) override;
  void leave(const PanelDetail& detail) override;
  ModulusSums plane_sums(size_t plane, SampleGroup group, bool is_kept) override;
  double add_gradient(size_t plane, SampleGroup group, double scale, double factor) override;
  void add_views(const ViewTargets& views, double scale, double factor) override;

 private:
  // A target, and the way to the samples of its plane; with a pupil, first to the window of the pupil.
  struct Way {
    DeviceTarget target;
    std::vector<Vec2> shifts;
    std::optional<DeviceConvolution> to_pupil;
    DeviceConvolution there;
    DeviceBuffer disc;
  };

  // The way to the plane of the pupils.
  struct Eyes {
    Grid window;
    DeviceConvolution there;
    ViewTransforms transforms;
  };

  const Grid& pixels() const { return lit_.slm.grid; }
  size_t bytes_of_samples() const {
    return size_t(pixels().pixels()) * size_t(lit_.params.subpixels * lit_.params.subpixels) *
           sizeof(std::complex<float>);
  }
  bool has_means(SampleGroup group) const { return has_pixel_means(group, lit_.params.subpixels); }
  DevicePlaneLight take_spare();
  void make(DeviceBuffer& buffer, size_t bytes, const char* what);
  std::vector<DisplacedSamples> samples_for(const Way& way, SampleGroup group, size_t frame, DevicePlaneLight& light);
  void to_plane(Way& way, const DeviceBuffer& u, const std::vector<DisplacedSamples>& samples);
  void to_panel(Way& way, const std::vector<DisplacedSamples>& samples);
  Eyes& eyes_for(const Pupil& pupil);
  void add_powers(const std::vector<DisplacedSamples>& samples, SampleGroup group, bool is_first,
                  DevicePlaneLight& light);

  Device& device_;
  PanelInLight lit_;
  DeviceDrivenPanel panel_;
  std::vector<DeviceFrame>& frames_;
  DeviceLightMemory& memory_;
  std::vector<Way> ways_;
  PanelDetail detail_;                       // of the light that left last
  std::optional<Eyes> eyes_;                 // made for the first views
  std::map<size_t, DevicePlaneLight> kept_;  // of planes whose gradient is not added yet
};

}  // namespace holotrace
