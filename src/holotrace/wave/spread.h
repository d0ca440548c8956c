#pragma once

#include <complex>
#include <vector>

#include "holotrace/wave/layer_spectrum.h"

namespace holotrace {

/// A point of light on a slice.
struct PointOnSlice {
  double column = 0, row = 0;      ///< in samples of the panel's pitch from pixel (0, 0), anywhere between them
  std::complex<float> strength{};  ///< what its spectrum has as factor
};

/// How points are spread over samples so that their transform is, within the band |k| ≤ K, that of the points times
/// a known factor (non-uniform FFT of type 1, Barnett, Magland & af Klinteberg, SIAM J. Sci. Comput. 41, C479, 2019):
///
///     φ(t) = exp(β(√(1 − (2t/w)²) − 1)),  |t| ≤ w/2 samples,   β = 0.97π·w(1 − 1/2σ)
///
/// σ, the samples per period over 2K + 1, is 1.25 or more; the transform of φ is divided out.
struct SpreadKernel {
  int width = 0;  ///< w [samples]
  double beta = 0;
};

/// A kernel that leaves a relative error of about `tolerance`, from 1e-7 on.
SpreadKernel make_spread_kernel(double tolerance);

/// Samples per period that hold the band |k| ≤ K.
int spread_length(int band, const SpreadKernel& kernel);

/// 1/φ̂ at |k| = 0 … K for rasters of that many samples per period.
std::vector<double> spread_correction(const SpreadKernel& kernel, int samples, int band);

/// Spreads points over a raster of samples_x × samples_y per window of nx × ny panel samples. The same bytes on any
/// number of threads. Cost: w² multiply-adds and 2w exponentials per point.
SliceSamples spread_points(const std::vector<PointOnSlice>& points, const SpreadKernel& kernel, int nx, int ny,
                           int samples_x, int samples_y);

}  // namespace holotrace
