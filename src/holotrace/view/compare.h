#pragma once

#include <complex>
#include <span>
#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/data/image.h"

namespace holotrace {

struct CompareParams {
  /// The bright region: pixels whose reference is at least this fraction of the reference's maximum.
  double bright = 0.1;
};

/// How an image differs from its reference in the bright region.
struct BrightMetrics {
  double speckle_contrast = 0;  ///< σ/μ of image/reference over the bright region, without shading
  double bright_fraction = 0;   ///< diffraction efficiency: fraction of the image's light in the bright region
  /// 1 − (b − a)/(b + a) of image/reference over the bright region, a and b its 1st and 99th percentiles. (The minimum
  /// and the maximum would depend on two pixels and their noise.) In [0, 1], 1 if all ratios are equal.
  double uniformity = 0;
};

/// How far s·image is from its reference. L is the reference's maximum.
struct ScaledError {
  double scale = 0;      ///< s for which s·image is nearest to the reference (least squares)
  double rms_error = 0;  ///< root mean square of reference − s·image [unit of the reference]
  double psnr = 0;       ///< 20·log₁₀(L/rms error) [dB], infinite if they agree
};

/// How an image differs from its reference.
struct Metrics : BrightMetrics, ScaledError {
  double psnr_amplitude = 0;  ///< the same for amplitudes √value, with their own scale, as encoders are judged
  double psnr_unscaled = 0;   ///< psnr of the image without a scale
  double ssim = 0;            ///< mean structural similarity of s·image, at most 1
  double ssim_unscaled = 0;   ///< ssim of the image without a scale
  double power_ratio = 0;     ///< all light of the image over all light of the reference
};

/// Compares an image with its reference, over all channels together. L is the reference's maximum.
///
/// SSIM is that of Wang et al., IEEE Trans. Image Process. 13, 600 (2004): Gaussian window of 11 × 11 pixels,
/// σ = 1.5, K₁ = 0.01, K₂ = 0.03, averaged over the pixels whose window lies inside the image (a smaller
/// image uses the largest odd window that fits) and over channels; population moments, linear values.
///
/// @throws Error  unless sizes and channels agree, values are finite and the reference has light
Metrics compare(const Image& reference, const Image& image, const CompareParams& params = {});

/// Scale, error and PSNR of `compare` alone. SSIM, which is left out, takes nearly all of its time.
/// @throws Error  as compare does
ScaledError scaled_error(const Image& reference, const Image& image);

/// The metrics of the pixels whose reference is at least a threshold [unit of the reference]; the sizes must agree.
BrightMetrics compare_bright(const Image& reference, const Image& image, double threshold);

/// The PSNR of a black image [dB], 20·log₁₀(L/root mean square of the reference): what an image without any light has.
/// @throws Error  for a reference without light
double psnr_of_black(const Image& reference);

/// Standard deviation over mean of all values: 1 for fully developed speckle, 1/√M for the mean of M such frames; 0 for
/// an image without light.
double speckle_contrast(const Image& image);

/// How a field differs from its reference.
struct FieldMetrics {
  double relative_error = 0;         ///< ‖f − r‖/‖r‖
  double scaled_error = 0;           ///< ‖s·f − r‖/‖r‖ = √(1 − |correlation|²)
  std::complex<double> scale;        ///< s for which s·f is nearest to r (least squares)
  std::complex<double> correlation;  ///< Σ r*·f/(‖r‖·‖f‖): its modulus is 1 if f is r times a constant
};

/// Compares a field with its reference.
/// @throws Error  unless both have the same number of rows and columns, and the reference has light
template <class Real>
FieldMetrics compare(const BasicField<Real>& reference, const BasicField<Real>& field);

/// ‖f − r‖/‖r‖ of colour fields, over all their samples together.
/// @throws Error  unless both have as many fields, of the same sizes and wavelengths (to 1e-9), and the reference has
///                light
template <class Real>
double relative_error(const std::vector<BasicField<Real>>& reference, const std::vector<BasicField<Real>>& fields);

/// Mean structural similarity of s·image and its reference, as defined in view/compare.h. The images have
/// the same size and channels; L > 0 is the maximum of the reference.
///
/// @param noise  noise of the reference at each of its values, up to a factor of mean square 1; in each window its variance
///               is subtracted from that of the reference. Empty: none
double structural_similarity(const Image& reference, const Image& image, double s, double L,
                             std::span<const float> noise = {});

}  // namespace holotrace
