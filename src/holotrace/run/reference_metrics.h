#pragma once

#include <vector>

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
/// ssim is that of the reference without such noise (compare.h). psnr_uncertainty_db is the possible error of
/// L, and that of twice this standard error; ssim_uncertainty is the change of ssim by that error of L. L is certain if all pixels
/// within 3·σ of it have all paths (they differ from the mean). Else it may be too low by 3·σ. σ² is ⟨d²⟩ over the other
/// pixels of at least L/2. E² − (1 − part)·⟨d²⟩ is taken as no less than its own standard error, (1 − part)·2·√Σe²d²/n. Speckle contrast, uniformity and bright_fraction are extrapolated from the mean and its halves,
/// which have twice its noise.
///
/// @param efficiency  fraction of the light on the panel that reaches the sensor
void report_metrics(const ViewReference& reference, const Image& view, double efficiency, const Observer& observer);

/// The values that pictures of a run show as white.
struct CommonExposure {
  double view_white = 1;    ///< [W/m²]
  double render_white = 1;  ///< [W/m²/sr]
};

/// Exposes views and renders alike: what should look equally bright in both has the same grey.
///
/// The exposure time that brings a view to its reference is ratio = Σ reference/Σ view, over the pixels whose reference
/// is at least a tenth of the largest. Then render_white = ratio·view_white, and view_white is the larger of the
/// views' own white and render_white of the renders alone (common_white), so that neither is clipped. A view with much
/// stray light does not make its render black: without `exposure`, render_white is at most twice that of the renders alone.
///
/// @param references  what the views should show, as many as views; none: the views are exposed alone
/// @param exposure    irradiance of white in views [W/m²]; 0: by the rule above
CommonExposure common_exposure(const std::vector<Image>& views, const std::vector<ViewReference>& references,
                               const std::vector<Image>& renders, double exposure);

/// The fraction of white from which on a pixel is lit. It is twice the stray light that sRGB assumes on a display (1 % of
/// white, the encoding viewing flare of IEC 61966-2-1): what is darker looks black. Fully developed speckle, whose mean is
/// at 0.43 of white (exposure_white), has 1 − exp(−0.02/0.43) = 5 % of its pixels below it.
inline constexpr double lit_level = 0.02;

/// The fraction of a picture's pixels of which one channel or more is at least lit_level of white. White is that of the
/// picture's automatic exposure (exposure_white), so that the fraction depends on no exposure. 0 for an image without light.
double lit_fraction(const Image& image);

/// The least lit fraction of a render with which metrics mean something. A black view differs from it by the lit pixels
/// alone: of equal ones, 0.1 % give it 10·lg(1/0.001) = 30 dB, as much as a good view has.
inline constexpr double least_lit_fraction = 0.001;

/// Reports which part of a render is lit, as the fact lit_fraction_of_render, and psnr_of_black_db, the PSNR of a black view
/// (view/compare.h); a render without light has no such figure. Warns if nearly nothing of the render is lit, so that
/// metrics say little.
/// @param render  what the view should show, on its pixels
void report_lit_render(const Image& render, const Observer& observer);

/// The least lit part of a view over that of its render with which waves look like a surface. 512² and 256² waves of the chess game
/// on 960 × 540 pixels have 1.1, 128² have 0.85, and 64², which are a lattice of dots, 0.31.
inline constexpr double least_lit_by_waves = 0.5;
inline constexpr double least_surface = 0.01;  ///< lit part of a render; what is smaller may be dots itself

/// Warns if the view is dark between waves that are too few. @param waves  number of waves of a frame
void warn_of_dots(const Image& view, const Image& render, size_t waves, const Observer& observer);

}  // namespace holotrace
