#pragma once

#include "holotrace/base/observer.h"
#include "holotrace/data/image.h"

namespace holotrace {

/// What a view is compared with.
struct ViewReference {
  Image image;  ///< on the view's pixels
  /// With a quick reference: its first half, whose paths are independent of the second's; `image` is the mean of both.
  Image first_half{};
  double part = 1;  ///< paths of `image` over those of a full reference
};

/// Reports how near a view is to its reference as facts: psnr_db, ssim, speckle_contrast, uniformity (view/compare.h),
/// bright_fraction, and diffraction_efficiency. A point's light may fall between the pixels of a render; without light
/// in the reference there is nothing to compare, and the fact why_no_metrics says so.
///
/// With a quick reference the error of the view holds the noise of the render. Its variance is the mean of d², d half of
/// the difference of both halves, on the view's pixels. A full reference has `part` of it, so that
///
///     psnr_db = 20·lg(L/√(E² − (1 − part)·⟨d²⟩)),   E the rms error, L the maximum of the reference
///
/// ssim is that of the reference's variance less (1 − part)·d². psnr_uncertainty_db is the sum of what L may lose and of a
/// tenth of the correction. L loses nothing if all pixels within 3·σ of it have all paths (renders.h: both halves agree
/// there); else up to 20·lg(1 + 3·σ/L). σ² is ⟨d²⟩ over the other pixels of at least L/2. Speckle contrast and uniformity
/// are left out.
///
/// @param efficiency  fraction of the light on the panel that reaches the sensor
void report_metrics(const ViewReference& reference, const Image& view, double efficiency, const Observer& observer);

}  // namespace holotrace
