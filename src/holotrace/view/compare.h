#pragma once

#include <complex>
#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/data/image.h"

namespace holotrace {

struct CompareParams {
  /// The bright region: pixels whose reference is at least this part of the reference's maximum.
  double bright = 0.1;
};

/// How an image differs from its reference.
struct Metrics {
  double scale = 0;             ///< s that makes s·image nearest to the reference (least squares)
  double rms_error = 0;         ///< root mean square of reference − s·image [unit of the reference]
  double psnr = 0;              ///< 20·log₁₀(L/rms error) of s·image [dB], infinite where they agree
  double psnr_amplitude = 0;    ///< the same of amplitudes √value, with a scale of their own: as encoders are judged
  double psnr_unscaled = 0;     ///< the same of the image as it is
  double ssim = 0;              ///< mean structural similarity of s·image, at most 1
  double ssim_unscaled = 0;     ///< the same of the image as it is
  double speckle_contrast = 0;  ///< σ/μ of image/reference over the bright region: shading divides out
  double bright_fraction = 0;   ///< diffraction efficiency: part of the image's light in the bright region
  double power_ratio = 0;       ///< all light of the image over all light of the reference
  /// 1 − (b − a)/(b + a) of image/reference over the bright region, a and b its 1st and 99th percentiles: the least and
  /// the greatest of all would tell of two pixels alone, and of their noise. In [0, 1], 1 where all are alike.
  double uniformity = 0;
};

/// Compares an image with its reference, L being the reference's maximum, over all channels together.
///
/// SSIM is Wang et al.'s, IEEE Trans. Image Process. 13, 600 (2004): Gaussian window of 11 × 11 pixels,
/// σ = 1.5, K₁ = 0.01, K₂ = 0.03, averaged over the pixels whose window lies inside the image (a smaller
/// image takes the largest odd window that fits) and over channels; population moments, linear values.
///
/// @throws Error  unless sizes and channels agree, values are finite and the reference has light
Metrics compare(const Image& reference, const Image& image, const CompareParams& params = {});

/// Standard deviation over mean of all values: 1 for fully developed speckle, 1/√M for M frames of it; 0 for
/// an image without light.
double speckle_contrast(const Image& image);

/// How a field differs from its reference.
struct FieldMetrics {
  double relative_error = 0;         ///< ‖f − r‖/‖r‖
  double scaled_error = 0;           ///< ‖s·f − r‖/‖r‖ = √(1 − |correlation|²)
  std::complex<double> scale;        ///< s that makes s·f nearest to r (least squares)
  std::complex<double> correlation;  ///< Σ r*·f/(‖r‖·‖f‖): modulus 1 where f is r times a constant
};

/// Compares a field with its reference.
/// @throws Error  unless both have the same number of rows and columns, and the reference has light
template <class Real>
FieldMetrics compare(const BasicField<Real>& reference, const BasicField<Real>& field);

/// ‖f − r‖/‖r‖ over fields in colour: all their samples together.
/// @throws Error  unless both have as many fields, of the same sizes and wavelengths (to 1e-9), and the reference has
///                light
template <class Real>
double relative_error(const std::vector<BasicField<Real>>& reference, const std::vector<BasicField<Real>>& fields);

}  // namespace holotrace
