#pragma once

#include <string>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/image.h"
#include "holotrace/data/job.h"

namespace holotrace {

/// A path-traced picture of a run, and its stage in the report.
struct PlannedRender {
  std::string stage;
  RenderParams params;  ///< parameters for `render`
};

/// References of a run: one for all camera distances. With a lens, or an eye off the panel's centre, positions in the
/// picture depend on the distance; then there is one for each.
///
/// They show the light that makes waves. Where a ray from the panel meets nothing there is none, so the background is
/// left out.
std::vector<PlannedRender> plan_renders(const Job& job);

/// What each eye of a viewer would see of the scene itself, focused where the holographic pair is; empty without
/// job.render.eye_separation.
std::vector<PlannedRender> plan_stereo_renders(const Job& job);

/// Parameters of a render that shows the light which makes waves: that of the job's path expressions, without the background.
RenderParams light_of_waves(const Job& job, RenderParams params);

/// Paths of a quick reference for a full one: a quarter, an even number.
int quick_paths(int paths);

/// A run has none with `reference = none`. With `quick` they have a quarter of the paths (at least 2), in two halves.
/// @throws Error  as `render` does
Image make_render(const Job& job, const RenderParams& params, const Observer& observer = {});

/// Whether a job compares its views with quick renders: it asks for them, and they have fewer paths than full ones.
bool is_quick(const Job& job);

/// A render of few paths, as the mean of two with independent paths.
struct HalvedRender {
  Image mean, first;  ///< mean of both, and the first
  /// The mean, but its brightest pixels have all paths of the job, as in its full render: the maximum of the picture, to
  /// which PSNR and SSIM refer, depends on few pixels. Only the maximum should be taken of it: where noise is high, pixels are
  /// replaced, and where it is low, they are not.
  Image brightest;
};

/// Brightest pixels that get all paths, in each of two steps, over all pixels: one in so many.
inline constexpr int pixels_per_brightest = 50;

/// A fiftieth of the pixels, the brightest ones, get all paths. Then so does up to another fiftieth: those that are still
/// brighter, and the neighbours of the brightest, as views take values between pixels.
/// @param params  of an even number of paths
HalvedRender make_halved_render(const Job& job, const RenderParams& params, const Observer& observer = {});

}  // namespace holotrace
