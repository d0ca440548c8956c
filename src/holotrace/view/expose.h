#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/camera.h"

namespace holotrace {

/// What a sensor in the field's plane reads: the irradiance |u|², averaged over each of its pixels.
///
/// A pixel is `params.binning` × `params.binning` samples (0 counts as 1: whoever knows the panel's pitch turns
/// "one panel pixel" into a number before). Where the field does not divide evenly, samples are cut off
/// evenly at opposite sides (the odd one at the right and at the bottom) and a warning says so. The window of
/// the sensor is that of the field: propagate to the sensor's size.
///
/// @param field   at the sensor, shape (ny, nx) [√(W/m²)]
/// @return        one channel, shape (ny/binning, nx/binning) [W/m²], pitch binning·pitch
/// @throws Error  if binning is negative or larger than the field
Image expose(const Field& field, const CameraParams& params, const Observer& observer = {});

/// The irradiance [W/m²] to show as white: `exposure` if it is above 0, else the 99.9th percentile of the
/// image's values (their maximum where that percentile is dark; 1 for an image dark everywhere).
double exposure_white(const Image& image, double exposure);

}  // namespace holotrace
