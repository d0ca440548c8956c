#pragma once

#include <optional>
#include <vector>

#include "holotrace/opencl/device.h"
#include "holotrace/wave/propagate/device_convolution.h"
#include "holotrace/wave/propagate/device_windows.h"
#include "holotrace/wave/propagate/propagation_cost.h"
#include "holotrace/wave/propagate/propagator.h"
#include "holotrace/wave/shared/device_field.h"
#include "holotrace/wave/transform/line_transform.h"

namespace holotrace {

/// Memory and transfers of a propagation on a device [bytes].
struct DevicePropagationCost {
  double kept = 0;     ///< the transfer function and all other factors, which are sent once and stay on the device
  double work = 0;     ///< memory during a propagation: both fields, and the spectrum in between
  double fields = 0;   ///< samples that are sent and fetched
  double largest = 0;  ///< the largest buffer
  double moved = 0;    ///< what the kernels read and write, if the device's caches hold nothing
};

/// A propagator on an OpenCL device, for fields in single precision, with the windows and the methods of the processor:
/// device_convolution.h, and for windows of another pitch device_windows.h. The transfer function and all
/// other factors are sent once, and stay on the device with this object.
class DevicePropagator {
 public:
  /// @throws Error  as Device does
  DevicePropagator(Device& device, const Propagator<float>& propagator);

  /// The field at the output window, on the device. The memory for it is allocated before the first kernel; all but the
  /// result is released at the end.
  /// @throws Error  as propagate and Device do, and for a field on another device
  ///
  /// It does not tell energy_beyond_band. Memory, for K frequencies along x (on a lattice K/2), rows in n and rows out m:
  /// 8·(max(n, m) + n + m)·K bytes and both fields; at other pitches 8·K per frequency along y too.
  DeviceField operator()(const DeviceField& field, const Observer& observer = {});

  /// The same for a field of the processor. Transfers: 8 bytes per sample of the input, and 8 per sample of the output.
  Field operator()(const Field& field, const Observer& observer = {});

  /// The same for samples that are on the device already, of the input and output windows. It returns when they are done.
  /// @throws Error  as Device does
  void run(const DeviceBuffer& from, const DeviceBuffer& to, const Observer& observer = {});

 private:
  struct Work;
  struct Ends {
    const DeviceBuffer &from, &to;
  };
  Work make_work();
  void run(const Ends& ends, const Work& work, const Observer& observer);
  void transform_to_window(const Ends& ends, const Work& work, const Observer& observer);

  Device& device_;
  Propagator<float> plan_;                        // without the transfer function
  std::optional<DeviceConvolution> convolution_;  // on a lattice; off it:
  std::optional<DeviceWindows> windows_;
  DeviceBuffer transfer_;
  int transfer_columns_;
};

/// The cost of a plan: it is run on a device that only counts.
/// @param memory  that the device has for it, of which long lines take work space [bytes]; by default all
DevicePropagationCost device_propagation_cost(const Device& device, const Propagator<float>& plan, double memory);
DevicePropagationCost device_propagation_cost(const Device& device, const Propagator<float>& plan);

}  // namespace holotrace
