#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/propagate/device_convolution.h"
#include "holotrace/wave/propagate/propagator.h"
#include "holotrace/wave/shared/device_field.h"
#include "holotrace/wave/transform/line_transform.h"

namespace holotrace {

/// A propagator on an OpenCL device, for fields in single precision, with the windows and the methods of the processor:
/// DeviceConvolution, and for windows of another pitch DeviceWindows. The transfer function and all
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

/// What a propagation takes on a device, by one that only counts: its transfer function and all other factors are sent and
/// held; fields are on the device, and are released with the memory of the work.
/// @param memory  that the device has for it, of which long lines take work space [bytes]; by default all
DeviceUse forecast_propagation(const Device& device, const Propagator<float>& plan, double memory);
DeviceUse forecast_propagation(const Device& device, const Propagator<float>& plan);

/// Bytes of the fields at both ends.
double bytes_of_fields(const Propagator<float>& plan);

/// How a propagation is cut to fit in some memory of a device.
struct BandedPlan {
  std::vector<ColumnBand> bands;  ///< of the spectrum
  int columns = 1;                ///< of the largest band
  int rows_in = 0, rows_out = 0;  ///< rows of both fields that are on the device at once
  bool has_fields = true;         ///< whether these are all rows
};

/// @param memory  free memory of the device [bytes]
BandedPlan plan_bands_of_spectrum(const Device& device, const Propagator<float>& plan, double memory);

/// A propagation whose transfer function, spectrum or fields do not fit in a device's memory: with the windows and the methods
/// of DevicePropagator, band by band of columns of the spectrum. The transfer function is sent with its columns. Fields that
/// do not fit beside a band are sent, and their sums fetched, some rows at a time and once for every band.
///
/// The device adds up the bands, so with another memory samples differ by rounding.
class BandedPropagation {
 public:
  /// @throws Error  as Device does
  BandedPropagation(Device& device, std::shared_ptr<const Propagator<float>> propagator);

  /// The field at the output window. All memory but that of factors is released at the end.
  /// @throws Error  as propagate and Device do
  Field operator()(const Field& field, const Observer& observer = {});

  /// The same, to the samples of `out`. A device that only counts needs no fields.
  void run(const Field* field, Field* out, const Observer& observer = {});

 private:
  struct Work;
  struct Turn;  // of a band
  Work make_work(const BandedPlan& plan);
  void send_transfer(const Turn& turn);
  void enter(const Field* field, const Turn& turn);
  void filter(const Turn& turn);
  void leave(const Turn& turn, Field* out);

  Device& device_;
  std::shared_ptr<const Propagator<float>> propagator_;
  std::optional<DeviceConvolution> convolution_;  // on a lattice; off it:
  std::optional<DeviceWindows> windows_;
  LineTransforms lines_;
};

/// What such a propagation takes on a device with that free memory [bytes], by one that only counts. Fields are sent and fetched,
/// and nothing is held.
DeviceUse forecast_banded_propagation(const Device& device, const Propagator<float>& plan, double memory);

}  // namespace holotrace
