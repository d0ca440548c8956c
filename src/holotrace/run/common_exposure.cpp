#include "holotrace/run/common_exposure.h"

#include <algorithm>

#include "holotrace/view/camera.h"

namespace holotrace {
namespace {

constexpr double bright = 0.1;       // of the largest value: where there is light to compare, as in view/compare.h
constexpr double most_darkened = 2;  // one photographic stop

// Radiance over irradiance in the bright regions of all views; 0 if it is unknown.
double light_ratio(const std::vector<Image>& views, const std::vector<ViewReference>& references) {
  float peak = 0;
  for (const ViewReference& reference : references)
    for (const float value : reference.image.values) peak = std::max(peak, value);
  double of_references = 0, of_views = 0;
  for (size_t d = 0; d < references.size(); ++d)
    for (size_t i = 0; i < references[d].image.values.size(); ++i) {
      if (references[d].image.values[i] < bright * double(peak)) continue;
      of_references += references[d].image.values[i];
      of_views += views[d].values[i];
    }
  return peak > 0 && of_views > 0 ? of_references / of_views : 0;
}

}  // namespace

CommonExposure common_exposure(const std::vector<Image>& views, const std::vector<ViewReference>& references,
                               const std::vector<Image>& renders, double exposure) {
  const CommonExposure alone{common_white(views, exposure), renders.empty() ? 1 : common_white(renders, 0)};
  const double ratio = light_ratio(views, references);
  if (ratio == 0) return alone;
  if (exposure > 0) return {exposure, ratio * exposure};
  const double view_white = std::max(alone.view_white, alone.render_white / ratio);
  return {view_white, std::min(ratio * view_white, most_darkened * alone.render_white)};
}

}  // namespace holotrace
