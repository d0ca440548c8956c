#pragma once

#include <array>
#include <complex>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/device_loops.h"
#include "holotrace/slm/encode/iterate/frames_on_device.h"
#include "holotrace/slm/encode/iterate/processor_arrays.h"
#include "holotrace/slm/encode/iterate/target_propagation.h"
#include "holotrace/wave/propagate/device_convolution.h"
#include "holotrace/wave/transform/line_transform.h"

namespace holotrace {

/// Transforms of views on a device, one after the other, and their memory.
struct ViewTransforms {
  Device& device;
  LineTransforms lines;
  std::array<DeviceBuffer, 2> work;

  explicit ViewTransforms(Device& device) : device(device), lines(device) {}
};

/// What a pupil should see, on a device, and its way from the light in the plane of the pupils (target_propagation.h).
class DeviceView {
 public:
  /// @param eye  window of that plane
  DeviceView(ViewTransforms& transforms, const Grid& eye, const ViewTargets& views, size_t view);

  /// Wanted moduli of the picture.
  const DeviceTarget& target() const { return target_; }

  /// Writes the picture that the pupil takes of the light in its plane.
  void take(ViewTransforms& transforms, const DeviceBuffer& eye, const DeviceBuffer& picture) const;

  /// Adds the adjoint of `take` for picture · factor to `eye`.
  void add_adjoint(ViewTransforms& transforms, const DeviceBuffer& picture, const DeviceBuffer& factor,
                   const DeviceBuffer& eye) const;

 private:
  struct Job;
  Job job() const;
  void transform(ViewTransforms& transforms, FftDirection direction) const;

  DeviceTarget target_;
  int length_, first_x_, first_y_, columns_;
  float scale_;
  DeviceBuffer along_x_, along_y_, spans_;
};

/// The light of one device's share of the frames at one wavelength: their part of the mean irradiance in the planes; and
/// gradients back to them, once that mean has become the factor of its residual. Of frames that stay on the device the light
/// stays there, too; that of others is computed again for each of its uses.
///
/// The device of the first share also has what the planes should show.
class FramesLight {
 public:
  /// @param frames    number of frames of all shares
  /// @param is_first  whether it is the light of the first share
  FramesLight(FramesOnDevice& share, const PanelInLight& panel, size_t frames, bool is_first);

  /// Adds a target plane, and the way there.
  void add(const TargetPlane& target, const TargetPropagation& way);

  /// Number of values of the light of each plane: one for each pixel.
  size_t pixels_of_plane() const { return size_t(pixels().pixels()); }

  /// The light that leaves the panel, for the rounded levels of these frames.
  void leave(const PanelDetail& detail);

  /// Carries the frames to a plane, where their light stays for the functions below.
  /// @param is_kept  whether samples stay for add_gradient
  void show(size_t plane, SampleGroup group, bool is_kept);

  /// Their part of the mean irradiance over each pixel of a plane.
  const DeviceBuffer& mean(size_t plane) const { return lights_.at(plane).mean; }

  /// Sums over a plane, and the step from its mean irradiance to the factor of its residual: of the first share, whose `mean`
  /// then is that of all frames.
  ModulusSums fit_sums(size_t plane);
  double leave_residual(size_t plane, double scale);

  /// Adds what comes back from the plane, given the factor in `mean`, to the slopes of the frames, times factor.
  void add_slopes(size_t plane, SampleGroup group, double factor);

  /// Forgets the light of a plane.
  void drop(size_t plane);

  /// The same for views, given the way to the window of their pupils: the frames' part of the mean irradiance in each view;
  /// sums and residual of a view, of the first share; and the slopes. Views that are dropped are forgotten.
  void show_views(const ViewTargets& views, const PupilPropagation& way, bool is_kept);
  const DeviceBuffer& mean_of_view(size_t view) const { return views_->mean[view]; }
  ModulusSums fit_sums_of_view(size_t view);
  double leave_residual_of_view(size_t view, double scale);
  void add_slopes_of_views(double factor);
  void drop_views();

 private:
  // A target, and the way to the samples of its plane.
  struct Way {
    std::optional<DeviceTarget> target;
    std::vector<Vec2> shifts;
    DeviceConvolution there;
  };

  // The way to a window of pupils.
  struct Eyes {
    Grid window;
    double z;
    DeviceConvolution there;
  };

  // Views of an update: their mean irradiance, and the samples of each frame and view, if they stay.
  struct Views {
    Eyes* eyes;
    std::vector<DeviceView> there;
    std::vector<DeviceBuffer> mean, pictures;
    Grid picture;
    bool are_kept;
  };

  const Grid& pixels() const { return lit_.slm.grid; }
  size_t bytes_of_samples() const {
    return size_t(pixels().pixels()) * size_t(lit_.params.subpixels * lit_.params.subpixels) *
           sizeof(std::complex<float>);
  }
  bool has_means(SampleGroup group) const { return has_pixel_means(group, lit_.params.subpixels); }
  LightBytes bytes_needed() const;
  void make(DeviceBuffer& buffer, size_t bytes, const char* what);
  DevicePlaneLight take_spare();
  const DeviceBuffer& light_of(size_t m, const DeviceFrame& frame);
  std::vector<DisplacedSamples> samples_for(const Way& way, SampleGroup group, size_t frame, DevicePlaneLight& light);
  void to_panel(Way& way, const std::vector<DisplacedSamples>& samples);
  Eyes& eyes_at(const PupilPropagation& way);
  void add_powers(const std::vector<DisplacedSamples>& samples, SampleGroup group, bool is_first,
                  DevicePlaneLight& light);
  void take_pictures(size_t m, const DeviceFrame& frame);
  const DeviceBuffer& picture_of(size_t m, size_t view) const;

  FramesOnDevice& share_;
  Device& device_;
  DeviceLightMemory& memory_;
  PanelInLight lit_;
  DeviceDrivenPanel panel_;
  double bytes_of_panel_;
  size_t frames_;
  bool is_first_;
  std::vector<Way> ways_;
  PanelDetail detail_;                         // of the light that left last
  std::map<size_t, DevicePlaneLight> lights_;  // of planes that are shown and not dropped yet
  std::deque<Eyes> eyes_;                      // to all windows that views have had
  std::optional<ViewTransforms> transforms_;
  std::optional<Views> views_;
};

}  // namespace holotrace
