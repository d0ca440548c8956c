#pragma once

#include <vector>

#include "holotrace/data/image.h"
#include "holotrace/run/reference_metrics.h"

namespace holotrace {

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

}  // namespace holotrace
