#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/job.h"
#include "holotrace/run/renders.h"

namespace holotrace {

/// What the views of holograms that aim at the scene's light are compared with, one for each of the camera's distances: renders
/// in two halves, whose paths are independent of each other and of those of the targets. They show the light that passes the
/// camera's pupil or, without one, the panel, on the panel's pixels in the plane in focus, and nothing is blurred. Two halves
/// give the error against a render without noise (report_metrics). Both have as many paths together as the job's
/// `reference` says; `brightest` is empty.
/// @return  none for `reference = none`
/// @throws Error  as `render` and `trace_focal_stack` do
std::vector<HalvedRender> trace_scene_references(const Job& job, const Observer& observer = {});

}  // namespace holotrace
