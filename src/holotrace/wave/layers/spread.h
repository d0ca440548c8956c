#pragma once

#include <complex>
#include <vector>

#include "holotrace/wave/layers/layer_spectrum.h"
#include "holotrace/wave/shared/gridding_kernel.h"

namespace holotrace {

/// A point of light on a slice.
struct PointOnSlice {
  double column = 0, row = 0;      ///< in samples of the panel's pitch from pixel (0, 0), anywhere between them
  std::complex<float> strength{};  ///< what its spectrum has as factor
};

/// How points are spread over samples so that their transform is, within the band |k| ≤ K, that of the points times
/// a known factor (non-uniform FFT of type 1): by the kernel of gridding_kernel.h, for σ = 1.25 samples or more per
/// period over 2K + 1. The transform of the kernel is divided out.
using SpreadKernel = SemicircleKernel;

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
