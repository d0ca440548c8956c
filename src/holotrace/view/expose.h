#pragma once

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/image.h"
#include "holotrace/data/params/camera.h"

namespace holotrace {

/// What a sensor in the field's plane reads: the irradiance |u|², integrated over each of its pixels and divided by
/// their area.
///
/// A pixel has the area of `params.binning` × `params.binning` samples (0 counts as 1: whoever knows the panel's pitch
/// turns "one panel pixel" into a number before). With params.sampling = integrate the field is sampled at half of its
/// pitch first, where |u|², whose band is twice the field's, is held: u between its samples is that of its band, dark
/// beyond its window, so that pixels near a border where the field ends abruptly ring. point is the mean of |u|² at the
/// samples of the field alone. Where the field does not divide evenly, samples are left out at its border with a
/// warning (pixels_of, sensor.h). The window of the sensor is that of the field: propagate to the sensor's size.
///
/// @param field   at the sensor, shape (ny, nx) [√(W/m²)]
/// @return        one channel, shape (ny/binning, nx/binning) [W/m²], pitch binning·pitch
/// @throws Error  if binning is negative or larger than the field
Image expose(const Field& field, const CameraParams& params, const Observer& observer = {});

/// |u|² at the samples, shape (ny, nx) [W/m²].
Array2D<float> irradiance_of(const Field& field);

/// Samples beyond a pixel's border that its integral needs.
inline constexpr int integration_rim = 2;

/// The mean of a quantity over the area of pixels of n × n samples, of which there are `rim` beyond the pixels on every
/// side.
///
/// Integrated (rim ≥ integration_rim): every sample counts with the mean over its own cell, which its neighbours tell,
///
///     ∫ I dx over a cell of side h = h·(I₀ + a·(I₋₁ − 2·I₀ + I₁) + b·(I₋₂ − 2·I₀ + I₂)),   a = 0.0684, b = −0.0087
///
/// a and b have the least square error of all frequencies up to the Nyquist frequency 1/2h in pixels of n = 2. On fully
/// developed speckle, an irradiance of mean 1 whose spectrum falls evenly to that frequency, the rms error is 0.26 % of
/// the mean at n = 2 and 3, 0.1 % at 4 and more, and 1.0 % at 1; plain means are off by 6.5, 3.0, 2.2 and 16 %. A
/// fringe loses no more than 0.6 % of its contrast at an even n. Below 0, where a bright place is near, counts as 0.
/// Else the plain mean of the samples.
///
/// @param values  shape (n·rows + 2·rim, n·columns + 2·rim)
/// @return        one channel, shape (rows, columns)
Image mean_over_pixels(const Array2D<float>& values, int n, int rim, bool is_integrated, const Observer& observer = {});

/// The irradiance [W/m²] to show as white: `exposure` if it is above 0, else the 99.9th percentile of the
/// image's values (their maximum where that percentile is dark; 1 for an image dark everywhere).
double exposure_white(const Image& image, double exposure);

}  // namespace holotrace
