#pragma once

#include <string>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/image.h"
#include "holotrace/data/job.h"

namespace holotrace {

/// A path-traced picture of a run, and the stage of the report that it is.
struct PlannedRender {
  std::string stage;
  RenderParams params;  ///< as `render` takes them
};

/// References of a run: one for all camera distances, or, with a lens or an eye off the panel's centre, where what lies
/// where in the picture depends on the distance, one for each.
///
/// They show the light that makes waves: where a ray from the panel meets nothing there is none, so the background is
/// left out.
std::vector<PlannedRender> plan_renders(const Job& job);

/// What each eye of a viewer would see of the scene itself, in focus where the holographic pair is; none without
/// job.render.eye_separation.
std::vector<PlannedRender> plan_stereo_renders(const Job& job);

/// @throws Error  as `render` does
Image make_render(const Job& job, const RenderParams& params, const Observer& observer = {});

}  // namespace holotrace
