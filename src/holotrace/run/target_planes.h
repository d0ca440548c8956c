#pragma once

#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/job.h"

namespace holotrace {

/// The aperture that the light of a job's holograms passes, for its depth of focus: the panel or, with eyes, their pupil.
struct Aperture {
  double side = 0;  ///< its largest side, or its diameter [m]
  double z = 0;     ///< its distance from the panel [m]
};
Aperture aperture_of(const Job& job);

/// Depth of focus as a step of the reciprocal distance from the aperture [1/m]: 2λ/w². Around the distance s it is 2λs²/w².
double depth_of_focus_of(const Job& job);

/// The depths of what the panel's window shows, added up, in depths of focus; 0 if nothing is there.
double depth_of_scene(const Job& job);

/// Distances of the target planes: those of the job or, if it names none, planes through the depths of the scene's surfaces
/// and of what mirrors and glass show (depth_ranges), evenly spaced in the reciprocal distance and at most one depth of focus
/// apart, but no more than `encode.planes`; the planes that the camera looks at come in addition. Light for all that look has
/// planes one depth of focus beyond the scene at both ends; for eyes, whose depth of focus is larger than most scenes, these
/// would cost more than they gain (docs/explanation/encoders.md). In increasing order.
/// @throws Error  for a scene without anything in the panel's window
std::vector<double> target_distances_of(const Job& job);

/// Warns if neighbouring planes that the job gives are more than 1.5 depths of focus apart: light between them is not
/// controlled.
void warn_of_sparse_planes(const Job& job, const Observer& observer);

}  // namespace holotrace
