#pragma once

#include "holotrace/wave/propagate/whole_shift.h"
#include "holotrace/wave/shared/device_field.h"

namespace holotrace {

/// |u|² at the samples, floats on the field's device [W/m²].
/// @throws Error  as Device does; so does the function below
DeviceBuffer irradiance_of(const DeviceField& field);

/// The samples of the field on another window of its lattice; 0 where the field has none.
DeviceField on_window(const DeviceField& field, const WindowShift& to);

}  // namespace holotrace
