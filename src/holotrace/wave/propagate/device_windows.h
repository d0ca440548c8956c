#pragma once

#include "holotrace/opencl/device.h"
#include "holotrace/wave/propagate/device_convolution.h"
#include "holotrace/wave/propagate/propagator.h"
#include "holotrace/wave/transform/line_transform.h"

namespace holotrace {

/// The steps of a propagation to a window of another pitch on an OpenCL device: those of DeviceConvolution, by the sums of
/// window_sum.h. All factors but the transfer function are sent once. Its spectrum has one part.
class DeviceWindows {
 public:
  /// @param plan    a propagation off the lattice
  /// @throws Error  as Device does
  DeviceWindows(Device& device, const Propagator<float>& plan);

  void enter(const ColumnBand& band, int rows, const DeviceBuffer& from, const DeviceBuffer& to);
  /// @param bins  the columns' frequencies along y
  void filter(const ColumnBand& band, const LineFactors& transfer, const DeviceBuffer& from, const DeviceBuffer& bins,
              const DeviceBuffer& to);
  void leave(const ColumnBand& band, int rows, bool adds, const DeviceBuffer& from, const DeviceBuffer& to);

  void transpose(int rows, int columns, const DeviceBuffer& from, const DeviceBuffer& to) {
    lines_.transpose(rows, columns, from, to);
  }

 private:
  struct Window {
    DeviceBuffer enter, chirp, leave;
    int length = 0;
    bool is_plain = false;
  };
  Window make_window(const PropagationAxis& axis);
  // Samples `first` … of the axis' frequencies, summed at the window.
  void sum(const Window& window, const PropagationAxis& axis, const ColumnBand& frequencies, int lines, bool adds,
           const DeviceBuffer& from, const DeviceBuffer& to);

  Device& device_;
  PropagationAxis x_, y_;
  LineTransforms lines_;
  Window to_x_, to_y_;
};

}  // namespace holotrace
