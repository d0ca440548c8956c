#pragma once

#include <vector>

#include "holotrace/data/image.h"
#include "holotrace/opencl/device.h"
#include "holotrace/view/expose.h"
#include "holotrace/view/pupil_light.h"
#include "holotrace/wave/shared/device_field.h"

// What a camera does with light on an OpenCL device, in single precision. Errors are those of Device.

namespace holotrace {

/// Keeps only the light in a pupil. @param open  the columns in each row of the field. Transfer: 8 bytes per row.
void cut_by_pupil(DeviceField& field, const std::vector<OpenColumns>& open);

/// mean_over_pixels (expose.h) of values on a device: floats, `nx` in each row. Transfer: 4 bytes per pixel come back.
Image mean_over_pixels(Device& device, const DeviceBuffer& values, int nx, const PixelSums& sums);

}  // namespace holotrace
