#pragma once

#include <vector>

#include "holotrace/data/field.h"
#include "holotrace/data/hologram.h"
#include "holotrace/data/image.h"
#include "holotrace/data/job.h"
#include "holotrace/data/report.h"
#include "holotrace/data/sources.h"
#include "holotrace/stage.h"

namespace holotrace {

/// Every box of the pipeline's picture, from a scene to what a viewer sees of its hologram.
struct Boxes {
  Image render;  ///< path-traced reference, seen from the panel's centre
  Sources sources;
  Field field;  ///< at the panel
  Hologram hologram;
  std::vector<Image> views;  ///< one per camera distance
  Report report;
};

/// The whole pipeline, one verb after the other.
/// @throws Error  as the stages do
Boxes run(const Job& job, const StageObserver& watch = {});

/// What the camera sees of the light that leaves an SLM, focused at `distance` [m] ≥ 0: behind the panel
/// for a virtual image, before it for a real one. Applies the stop that the encoder asked for.
Image look(const Field& shown, const Slm& slm, double distance, const PropagateParams& propagation,
           const CameraParams& camera, const Observer& observer = {});

/// The irradiance that is white in all the views: the exposure given, or the brightest view's own.
double common_white(const std::vector<Image>& views, double exposure);

/// The render as the sensor would see it: what stands at `distance` falls on the sensor's pixels at
/// x = distance·tan. Pixels past the render's window are black.
Image project_render(const Image& render, double half_tangent, const Image& sensor, double distance);

}  // namespace holotrace
