#pragma once

#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/base/observer.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// Samples beyond a pixel's border that its integral needs.
inline constexpr int integration_rim = 2;

/// The mean of a quantity over the area of pixels of n × n samples; there are `rim` more samples beyond the pixels on
/// every side.
///
/// Integrated (rim ≥ integration_rim): each sample contributes the mean over its own cell, from its neighbours,
///
///     ∫ I dx over a cell of side h = h·(I₀ + a·(I₋₁ − 2·I₀ + I₁) + b·(I₋₂ − 2·I₀ + I₂)),   a = 0.0684, b = −0.0087
///
/// a and b minimize the square error over frequencies up to the Nyquist frequency 1/2h in pixels of n = 2. For fully
/// developed speckle, an irradiance of mean 1 whose spectrum falls evenly to that frequency, the rms error in % of the
/// mean is 0.96 at n = 1, 0.26 at 2 and 3, 0.14 at 4, 0.12 at 5 and below 0.08 from 6 on; plain means have 16, 6.5,
/// 3.0 and 2.2 at n = 1 … 4. The contrast that a pixel keeps of a fringe is wrong by at most 0.006 at even n. At odd n
/// the largest error, near the Nyquist frequency, is 0.09 at n = 1, 0.03 at 3, 0.018 at 5 and 0.013 at 7.
/// Values below 0, which occur near bright places, are set to 0.
/// Otherwise: the plain mean of the samples.
///
/// @param values  shape (n·rows + 2·rim, n·columns + 2·rim)
/// @return        one channel, shape (rows, columns)
/// @throws Error  for pixels without a sample, and for a rim that is too small
Image mean_over_pixels(const Array2D<float>& values, int n, int rim, bool is_integrated, const Observer& observer = {});

/// How mean_over_pixels adds up samples:
///
///     pixel(row, column) = max(0, Σ_j Σ_i weights[j]·weights[i]·values[first + row·n + j][first + column·n + i])/n²
struct PixelSums {
  int rows = 0, columns = 0;  ///< pixels
  int n = 1, first = 0;
  int across = 0;  ///< samples of a row from `first` on that a row of pixels needs
  std::vector<double> weights{};
};
/// @throws Error  as mean_over_pixels does
PixelSums pixel_sums(int ny, int nx, int n, int rim, bool is_integrated);

/// The irradiance [W/m²] to show as white: `exposure` if it is above 0, otherwise the larger of
///
///     1.25 × the 99.9th percentile of the means over blocks of 8 × 8 pixels, and
///     the level W above which a tenth of the light lies: Σ max(v − W, 0) = 0.1·Σ v
///
/// The first is for surfaces: a white one is shown at 0.8 of white (sRGB 231 of 255), and blocks average speckle. The
/// second is for what is smaller than a block, such as points and lines, and for strong speckle: fully developed, its
/// mean is then at 1/ln 10 = 0.43 of white (sRGB 175). 1 for an image without light.
double exposure_white(const Image& image, double exposure);

}  // namespace holotrace
