#pragma once

#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/image.h"
#include "holotrace/data/job.h"
#include "holotrace/data/report.h"
#include "holotrace/data/sources.h"
#include "holotrace/run/check_job.h"
#include "holotrace/run/scene_light.h"
#include "holotrace/run/stage.h"
#include "holotrace/run/view_series.h"
#include "holotrace/run/viewpoints.h"

namespace holotrace {

/// Every box of the pipeline's picture, from a scene to what a viewer sees of its holograms.
///
/// A **set** is the light of one path group or lamp at one wavelength; a run shows frames × sets holograms, one after the
/// other.
struct Boxes {
  /// Path-traced references in red, green and blue: one from the panel's centre, or with a lens or another eye one per
  /// camera distance, focused there.
  std::vector<Image> renders;
  std::vector<Sources> sources;            ///< of the first frame, one per set; none with gather and triangles
  std::vector<std::vector<Field>> fields;  ///< at the panel in the first frame, [path group or light][wavelength]
  std::vector<Hologram> holograms;         ///< in the order shown: for each frame, each set
  std::vector<Image> views;                ///< one per camera distance: one channel, or red, green and blue
  double white = 1;                        ///< of those views [W/m²]
  ViewSeries sweep;                        ///< where job.camera asks for one
  /// With job.render.eye_separation: the render for the left and the right eye, and what they see of the holograms.
  std::vector<Image> stereo_renders;
  ViewSeries stereo_views;
  std::vector<Viewpoint> viewpoints;  ///< of all views
  Report report;
};

/// The whole pipeline, one verb after the other. Each frame m of job.trace.frames gives the waves of every set
/// independent phases (set_frame: no tracing anew), and its holograms are shown with irradiances in proportion to
/// their illumination, the brightest with job.show.irradiance; the camera averages frames and illumination states and adds sets
/// (viewing.h). A set without waves, as green light of a red scene, is dark. Encoders that iterate look at the camera's
/// distances where the job names none for them.
///
/// With more than one hologram, or light of several illumination states, the report has one entry per kind of stage: the seconds of
/// all, the facts of the first (waves and waves_pixels summed), each warning once.
/// @throws Error  as the stages do, and before the first where the job does not fit in the machine's memory
Boxes run(const Job& job, const StageObserver& watch = {});

}  // namespace holotrace
