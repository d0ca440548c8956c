#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// What a view is compared with.
struct ViewReference {
  Image image;  ///< on the view's pixels; of a quick reference the one whose brightest pixels have all paths
  /// Of a quick reference: the mean of its halves, and its first half, whose paths are independent of the second's.
  Image mean{}, first_half{};
  double part = 1;  ///< paths of `mean` over those of a full reference
};

/// Reports how near a view is to its reference as facts: psnr_db, ssim, speckle_contrast, uniformity (view/compare.h),
/// bright_fraction, and diffraction_efficiency. A point's light may fall between the pixels of a render; without light
/// in the reference there is nothing to compare, and the fact why_no_metrics says so.
///
/// With a quick reference the error of the view holds the noise of the render. Its variance is the mean of d², d half of
/// the difference of both halves, on the view's pixels. A full reference has `part` of it, so that
///
///     psnr_db = 20·lg(L/√(E² − (1 − part)·⟨d²⟩)),   E the rms error of the mean, L the maximum of `image`
///
/// ssim is that of the reference without such noise (structural_similarity.h). psnr_uncertainty_db is the possible error of
/// L, and that of twice this standard error; ssim_uncertainty is the change of ssim by that error of L. L is certain if all pixels
/// within 3·σ of it have all paths (they differ from the mean). Else it may be too low by 3·σ. σ² is ⟨d²⟩ over the other
/// pixels of at least L/2. E² − (1 − part)·⟨d²⟩ is taken as no less than its own standard error, (1 − part)·2·√Σe²d²/n. Speckle contrast, uniformity and bright_fraction are extrapolated from the mean and its halves,
/// which have twice its noise.
///
/// @param efficiency  fraction of the light on the panel that reaches the sensor
void report_metrics(const ViewReference& reference, const Image& view, double efficiency, const Observer& observer);

}  // namespace holotrace
