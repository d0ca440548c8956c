#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/propagate/device_propagator.h"
#include "holotrace/wave/propagate/device_windows.h"

namespace holotrace {

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

/// What such a propagation takes on a device with that free memory: it is run on one that only counts. Nothing is kept, so
/// `fields` has all that is transferred.
DevicePropagationCost banded_propagation_cost(const Device& device, const Propagator<float>& plan, double memory);

}  // namespace holotrace
