#pragma once

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/field.h"
#include "holotrace/data/image.h"

namespace holotrace {

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
/// developed speckle, an irradiance of mean 1 whose spectrum falls evenly to that frequency, the rms error in % of the
/// mean is 0.96 at n = 1, 0.26 at 2 and 3, 0.14 at 4, 0.12 at 5 and below 0.08 from 6 on; plain means are off by 16, 6.5,
/// 3.0 and 2.2 at n = 1 … 4. The contrast that a pixel keeps of a fringe is off by no more than 0.006 at even n. At odd n
/// it is off the most for fringes near the Nyquist frequency: by 0.09 at n = 1, 0.03 at 3, 0.018 at 5 and 0.013 at 7.
/// Below 0, where a bright place is near, counts as 0.
/// Else the plain mean of the samples.
///
/// @param values  shape (n·rows + 2·rim, n·columns + 2·rim)
/// @return        one channel, shape (rows, columns)
Image mean_over_pixels(const Array2D<float>& values, int n, int rim, bool is_integrated, const Observer& observer = {});

/// The irradiance [W/m²] to show as white: `exposure` if it is above 0, else the 99.9th percentile of the
/// image's values (their maximum where that percentile is dark; 1 for an image dark everywhere).
double exposure_white(const Image& image, double exposure);

}  // namespace holotrace
