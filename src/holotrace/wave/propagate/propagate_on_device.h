#pragma once

#include <optional>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/params/propagate.h"
#include "holotrace/opencl/device.h"
#include "holotrace/wave/propagate/propagator.h"
#include "holotrace/wave/propagate/propagator_cache.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {

/// |u|² at the samples, floats on the field's device [W/m²].
/// @throws Error  as Device does; so does the function below
DeviceBuffer irradiance_of(const DeviceField& field);

/// The samples of the field on another window of its lattice; 0 where the field has none.
DeviceField on_window(const DeviceField& field, const WindowShift& to);

/// The field after propagation, on the device where it is. Its propagator stays there for the next field over the same
/// distance. Before a propagation that would not fit, others make room; if the device fails, all are dropped.
/// @throws Error  as propagate and Device do
/// Facts: as propagate.
DeviceField propagate(const DeviceField& field, double distance, const PropagateParams& params,
                      const Observer& observer = {});

/// The field after propagation on the device that params.device names, from the processor and back.
///
/// The device `auto` is the one that is expected to be the fastest, by the rates of stage_on_device.h: both fields are
/// transferred, and the transfer function unless it is there already. If it fails, a warning says why.
///
/// Facts: those of make_propagator, told for every field, and `device`, its name.
/// @return        nothing if the processor should do it
/// @throws Error  for a device that is not there, and as make_propagator and DevicePropagator do
std::optional<Field> propagate_on_device(const Field& field, double distance, const PropagateParams& params,
                                         const Observer& observer = {});

/// The same for the irradiance of that field, shape (ny, nx) [W/m²].
std::optional<Array2D<float>> irradiance_on_device(const Field& field, double distance, const PropagateParams& params,
                                                   const Observer& observer = {});

/// What a propagation is expected to take, without the transfers of its fields.
class PropagationForecast {
 public:
  /// @throws Error  as plan_propagator does
  PropagationForecast(const Grid& grid, double wavelength, double distance, const PropagateParams& params);

  double on_processor() const;             ///< [s]
  double on_device(Device& device) const;  ///< with the transfer function, unless it is there [s]
  double bytes_out() const;                ///< of the field at the output window

 private:
  PropagationQuestion question_;
  std::optional<Propagator<float>> plan_;  // none for samples that only change their window
  double bytes_out_;
};

/// Devices propagate in single precision.
/// @throws Error  unless params.device is the processor or `auto`, which then is the processor
void refuse_device_for_double(const PropagateParams& params);

/// Limit of the propagators that are kept on a device [bytes]: a quarter of its memory, unless limit_device_propagators
/// was called.
double device_propagator_bytes(const Device& device);

/// Lowers that limit for all devices, and drops the propagators beyond it. 0: none is kept.
void limit_device_propagators(double bytes);

/// Releases the memory of all propagators that are kept on devices.
void drop_device_propagators();

}  // namespace holotrace
