#pragma once

#include <array>
#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/data/target.h"
#include "holotrace/slm/encode/iterate/processor_loops.h"

// Sums over a target plane: within a row in float, over rows in double and in order; the same on any number of threads.
// The light of a plane is its power, the mean irradiance over each pixel, shape (ny, nx), and A = √power.

namespace holotrace {

/// One value for each of the four samples of a pixel, in the order of PixelSamples::four.
using SamplePower = std::array<Array2D<float>, 4>;

/// Σw·a².
double target_power(const TargetPlane& target);

/// Σa² over all pictures.
double target_power(const ViewTargets& views);

/// power ← power + factor·Σ|v|², the sum over the samples of a pixel: one in each of several fields, or n × n in one
/// field that is n times as fine.
void add_power(const std::vector<Field>& samples, double factor, Array2D<float>& power);

/// The same for one sample per pixel, or n × n.
void add_power(const Field& samples, double factor, Array2D<float>& power);

/// The power of one set of samples.
Array2D<float> power_of(const std::vector<Field>& samples, const Grid& pixels);

/// The mean irradiance over each pixel from the power at its four samples (PixelSamples::four, in their order) and at the
/// nearest ones of its neighbours: they count 0.471, 0.471 and 0.029, 0.029 along each axis. An irradiance of f cycles per
/// pixel is multiplied by 2·0.471·cos(πf/2) + 2·0.029·cos(3πf/2), which is sinc(f) to 0.013 for f ≤ 1. The four samples
/// alone differ by 0.087: iterations leave error there, and do not see it.
Array2D<float> pixel_means(const SamplePower& power);

/// v ← factor·v at all samples of each pixel.
void multiply(const Array2D<float>& factor, std::vector<Field>& samples);
void multiply(const Array2D<float>& factor, Field& samples);

/// Σw·a·A and Σw·A². Without weights, w is 1.
ModulusSums fit_sums(const Array2D<float>& amplitude, const Array2D<float>& weight, const Array2D<float>& power);
inline ModulusSums fit_sums(const TargetPlane& target, const Array2D<float>& power) {
  return fit_sums(target.amplitude, target.weight, power);
}

/// Σw·(A − s·a)².
double modulus_error(const TargetPlane& target, const Array2D<float>& power, double scale);

/// As modulus_error; the power becomes the factor w·(s·a − A)/A, which turns the light into its residual.
double leave_residual(const Array2D<float>& amplitude, const Array2D<float>& weight, double scale,
                      Array2D<float>& power);
inline double leave_residual(const TargetPlane& target, double scale, Array2D<float>& power) {
  return leave_residual(target.amplitude, target.weight, scale, power);
}

/// to ← to + factor·from, or factor·from where `to` has no samples yet.
void add_part(const Field& from, double factor, Field& to);

/// The largest a where w is not 0: the peak of the PSNR.
double target_peak(const TargetPlane& target);

/// Whether one sample of a pixel can stand for its mean. A sample is a quarter of a pixel from the middle, so it differs from
/// the mean by about a quarter of the step to the next pixel. True if that is at most 1 % of the peak (40 dB), rms over the
/// pixels that count.
bool is_smooth(const TargetPlane& target);

}  // namespace holotrace
