#pragma once

#include <array>

#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/device_loops.h"
#include "holotrace/wave/transform/line_transform.h"

namespace holotrace {

/// Transforms of views on a device, one after the other, and their memory.
struct ViewTransforms {
  Device& device;
  LineTransforms lines;
  std::array<DeviceBuffer, 2> work;

  explicit ViewTransforms(Device& device) : device(device), lines(device) {}
};

/// What a pupil should see, on a device, and its way from the light in the plane of the pupils (pupil_propagation.h).
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

}  // namespace holotrace
