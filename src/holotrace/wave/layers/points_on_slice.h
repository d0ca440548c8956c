#pragma once

#include <complex>
#include <vector>

#include "holotrace/base/array.h"
#include "holotrace/wave/layers/layer_spectrum.h"
#include "holotrace/wave/shared/gridding_kernel.h"

namespace holotrace {

/// A point of light on a slice.
struct PointOnSlice {
  double column = 0, row = 0;      ///< position in samples of the panel's pitch from pixel (0, 0); any real number
  std::complex<float> strength{};  ///< complex factor of its spectrum
};

/// Kernel that spreads points over samples (non-uniform FFT of type 1): within the band |k| ≤ K the transform of the
/// samples is that of the points times a known factor. It is the kernel of gridding_kernel.h, for 1.25·(2K + 1) samples
/// or more per period (σ ≥ 1.25). The transform of the kernel is divided out afterwards.
using SpreadKernel = SemicircleKernel;

/// A kernel with a relative error of about `tolerance`, down to 1e-7.
SpreadKernel make_spread_kernel(double tolerance);

/// Number of samples per period needed for the band |k| ≤ K.
int spread_length(int band, const SpreadKernel& kernel);

/// The factors 1/φ̂ at |k| = 0 … K that divide out the kernel, for rasters of `samples` samples per period.
std::vector<double> spread_correction(const SpreadKernel& kernel, int samples, int band);

/// Spreads points over a raster of samples_x × samples_y per window of nx × ny panel samples. The result has the same
/// bytes on any number of threads. Cost: w² multiply-adds and 2w exponentials per point.
SliceSamples spread_points(const std::vector<PointOnSlice>& points, const SpreadKernel& kernel, int nx, int ny,
                           int samples_x, int samples_y);

/// How far each point of a set hides what lies behind it: the radius of its disc. It is the largest distance, in the
/// plane, to the four points that are nearest in space, divided by √2. Discs of this radius just cover a square lattice
/// of points, and 84 % of a random scatter. The radius does not depend on the slices. It is at most three times the
/// median and at least half a sample; a lone point has half a sample.
///
/// @param points  points, in samples from pixel (0, 0)
/// @param depths  depth of each point, in samples too
/// @return        radius of each point's disc [samples]
std::vector<double> silhouette_radii(const std::vector<PointOnSlice>& points, const std::vector<double>& depths);

/// The mask of a slice's points: each hides what is behind its disc.
///
/// @param points  points, in samples from pixel (0, 0); the window repeats after nx × ny samples
/// @return        shape (ny, nx): 1 where a disc covers the sample's centre, else 0
Array2D<float> silhouette_of(const std::vector<PointOnSlice>& points, const std::vector<double>& radii, int nx, int ny);

}  // namespace holotrace
